# What a turn of a closed way gives out, of what it stores (laws.csv): a mark for each depth and
# direction that gives, by shape and scaling. What is less than the axis has lies on the frame's edge.
call ARG0[1:strlen(ARG0)-strlen('laws.gp')].'common.gp' ARG1
table = folder.'laws.csv'

is_way(v) = strcol('law') eq 'closed_way' && strcol('quantity') eq 'given_out_of_stored_percent'
shapes = ''; scalings = ''
stats table using (is_way(0) ? (shapes = with_word(shapes, strcol('shape')), \
  scalings = with_word(scalings, strcol('scaling')), 0) : 0) nooutput
count = words(scalings)
low = 0.01
place(s) = place_in(shapes, strcol('shape')) + 0.18*(s - 0.5*(count + 1))
given(s) = is_way(0) && strcol('scaling') eq word(scalings, s) && column('value') > 0 ? \
  (column('value') < low ? low : column('value')) : NaN

set terminal pngcairo size 1200,640 @look
set logscale y
set yrange [low:500]
set xrange [0.5:words(shapes) + 0.5]
set xtics () 
do for [i=1:words(shapes)] { set xtics add (spaced(word(shapes, i)) i) }
set ytics ('0.01 %%' 0.01, '0.1' 0.1, '0.5' 0.5, '1' 1, '10' 10, '100 %%' 100)
set ylabel 'energy given out a turn, of what is stored' @dark
set title 'A closed way across an edge gives out no energy: better is further down' font 'sans,14' @black
set key outside right top Left reverse samplen 1 spacing 1.5 font 'sans,11' @black
set arrow 1 from graph 0,first 0.5 to graph 1,first 0.5 nohead lw 1.5 dt '-' lc rgb '#009e73'
plot for [s=1:count] table using (place(s)):(given(s)) with points ls 20+s ps 1.4 \
  title word(scalings, s)
