# Error of the net force against the time of a tick (pareto.csv): every row a mark in its method's
# colour, those with the first distance field joined; the front a staircase with its settings named.
call ARG0[1:strlen(ARG0)-strlen('pareto.gp')].'common.gp' ARG1
table = folder.'pareto.csv'

@find_methods
fields = ''
stats table using (fields = with_word(fields, strcol('field_samples')), 0) nooutput
first = word(fields, 1)
others = ''
do for [f=2:words(fields)] { others = others.(strlen(others) ? ', ' : '').word(fields, f) }
if (words(fields) == 5) { others = others.' (auto)' }
stats table using 'tick_us':'force_error_pct' name 'cloud' nooutput

# A staircase: what is better than a mark is below it and to its left.
on_front(value) = column('on_front') == 1 ? value : NaN
stats table using (on_front(column('tick_us'))):(column('force_error_pct')) name 'front' nooutput
# Names stand once for the fields of a setting that differ little: at the best of them.
names = ''; best = ''
key(k) = strcol('method').':'.strcol('ns')
stats table using (on_front(0) == 0 ? (names = with_word(names, key(0)), 0) : NaN) nooutput
array least[words(names)]
do for [i=1:words(names)] {
  stats table using (key(0) eq word(names, i) ? on_front(column('force_error_pct')) : NaN) name 'one' nooutput
  least[i] = one_min
}
named(value) = column('on_front') == 1 && column('force_error_pct') == least[place_in(names, key(0))] ? \
  value : NaN

set terminal pngcairo size 1200,760 @look
set logscale xy
set xtics ('10 us' 10, '20' 20, '50' 50, '100 us' 100, '200' 200, '500' 500, '1 ms' 1e3, '2' 2e3, '5' 5e3, \
  '10 ms' 1e4, '20' 2e4, '50' 5e4, '100 ms' 1e5)
set ytics ('0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '0.7' 0.7, '1 %%' 1, '1.5' 1.5, '2' 2, '3' 3, '5' 5, '7' 7, \
  '10 %%' 10, '15' 15, '20' 20, '30' 30)
set xlabel 'time of a tick, one thread' @dark
set ylabel 'error of the net force, RMS' @dark
title = "Force and time of a tick on the molar, a burr of 20 voxels' radius pressed in by 4"
set title title font 'sans,13' @black offset 0,0.8
set label 1 'Lines: NS rising, a distance field of '.first.' samples across. Small marks: '.others.'.' \
  at graph 0.5,1.02 center font 'sans,10' @grey
set key outside right top Left reverse samplen 2 spacing 1.4 font 'sans,12' @black
# Names lie before the front, where no mark can be.
set xrange [cloud_min_x/3:cloud_max_x*1.3]
set yrange [cloud_min_y/1.5:cloud_max_y*1.2]
of(m, joined, value) = strcol('method') eq m && (strcol('field_samples') eq first) == joined ? value : NaN
plot for [m in backwards(found)] table using (of(m, 0, column('tick_us'))):'force_error_pct' \
  with points ls style(m) ps 0.6 notitle, \
     for [m in backwards(found)] table using (of(m, 1, column('tick_us'))):'force_error_pct' \
       with linespoints ls style(m) ps 1.3 notitle, \
     table using (front_min_x):(front_max_y):(0):(cloud_max_y*1.2 - front_max_y) every ::0::0 with vectors \
       nohead lw 1.6 lc rgb '#111111' notitle, \
     table using (on_front(column('tick_us'))):'force_error_pct' smooth unique with steps lw 1.6 \
       lc rgb '#111111' notitle, \
     table using (front_max_x):(front_min_y):(cloud_max_x*1.3 - front_max_x):(0) every ::0::0 with vectors \
       nohead lw 1.6 lc rgb '#111111' notitle, \
     table using (named(column('tick_us'))):'force_error_pct':(strcol('method').' '.strcol('ns')) \
       with labels right rotate by 25 offset -0.8,-0.3 font 'sans,10' @black notitle, \
     for [m in found] NaN with linespoints ls style(m) ps 1.3 title m, \
     NaN with lines lw 1.6 lc rgb '#111111' title 'the front'
