# Speed against accuracy (normals.csv) of the one shape that normals_charts.csv names for it.
call ARG0[1:strlen(ARG0)-strlen('speed_accuracy.gp')].'common.gp' ARG1
table = folder.'normals.csv'
marked = 6  # the neighbourhood that the paper settles on

charts = folder.'normals_charts.csv'
stats charts using (strcol('chart') eq 'speed_accuracy' ? (line = int($0), zone = strcol('zone'), 0) : NaN) \
  nooutput
@texts
stats charts using (int($0) == line ? (title = strcol(2), 0) : NaN) nooutput
@tables
@find_methods

error(deg) = deg < 0.01 ? 0.01 : deg
ns_of(method) = strcol('zone') eq zone && strcol('method') eq method ? column('ns_per_normal') : NaN

set terminal pngcairo size 1000,640 @look
stats table using (strcol('zone') eq zone ? column('ns_per_normal') : NaN):(error(column('mae_deg'))) nooutput
set xrange [STATS_min_x/1.3:STATS_max_x*1.3]
set yrange [STATS_min_y/1.2:STATS_max_y*1.2]
set logscale xy
@normal_tics
set title 'Contact normals on the '.title.sprintf(': accuracy against speed, large marks NS = %d', marked) \
  font 'sans,14' @black
set xlabel 'time of one normal, one thread' @dark
set ylabel 'mean error, degrees' @dark
set key outside right center Left reverse samplen 3 spacing 1.4 font 'sans,12' @black
ours = ''
do for [m in ' ldm ldm_fast'] { if (has(found, m)) { ours = ours.' '.m } }
plot for [m in backwards(found)] table using (ns_of(m)):(error(column('mae_deg'))) with linespoints \
  ls style(m) ps 0.55 notitle, \
     for [m in backwards(found)] table using (ns_of(m)):(column('ns') == marked ? error(column('mae_deg')) : \
       NaN) with points ls style(m) ps 1.9 notitle, \
     for [m in ours] table using (ns_of(m)):(error(column('mae_deg'))):(strcol('ns')) with labels \
       offset 0,-1.1 font 'sans,9' tc ls style(m) notitle, \
     for [m in found] NaN with linespoints ls style(m) ps 1.5 title m
