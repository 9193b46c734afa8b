# Time and places read for one normal (cost.csv) over n = 2 NS + 1, with the exponents of n that fit
# best [Kim and Park 2019, VI-C: n^2 against n^3].
call ARG0[1:strlen(ARG0)-strlen('cost.gp')].'common.gp' ARG1
table = folder.'cost.csv'

charts = folder.'normals_charts.csv'
stats charts using (strcol('chart') eq 'cost' ? (line = int($0), zone = strcol('zone'), 0) : NaN) nooutput
@texts
stats charts using (int($0) == line ? (title = strcol(2), 0) : NaN) nooutput
@tables
@find_methods

n(method) = strcol('method') eq method ? 2*column('ns') + 1 : NaN
array names[words(found)]
do for [i=1:words(found)] {
  names[i] = word(found, i)
  stats table using (log(n(names[i]))):(log(column('ns_per_normal'))) name 'time' nooutput
  stats table using (log(n(names[i]))):(log(column('readouts'))) name 'reads' nooutput
  if (time_records > 1) { names[i] = names[i].sprintf(':  n^%.1f,  n^%.0f', time_slope, reads_slope) }
}

set terminal pngcairo size 1400,560 @look
set logscale xy
set xtics (3, 5, 7, 9, 11, 13, 17, 25)
set xrange [2.7:28]
set xlabel 'n = 2 NS + 1' @dark
set multiplot layout 1,2
set key off
set lmargin at screen 0.06; set rmargin at screen 0.38
set title 'Time of one normal on the '.title.', one thread' @black
set ytics ('10 ns' 10, '100 ns' 100, '1 us' 1e3, '10 us' 1e4, '100 us' 1e5, '1 ms' 1e6)
plot for [m in found] table using (n(m)):(column('ns_per_normal')) with linespoints ls style(m) ps 0.9
set lmargin at screen 0.44; set rmargin at screen 0.76
set key at screen 0.77,0.85 left top Left reverse samplen 2 spacing 1.5 font 'sans,11' @black \
  title 'growth of time, of places read' left
set title 'Places read for one normal' @black
set ytics (10, 100, 1000, 10000)
plot for [i=1:words(found)] table using (n(word(found, i))):(column('readouts')) with linespoints \
  ls style(word(found, i)) ps 0.9 title names[i]
unset multiplot
