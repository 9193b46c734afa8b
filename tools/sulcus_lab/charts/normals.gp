# Speed against accuracy (normals.csv), a panel for each line of normals_charts.csv.
call ARG0[1:strlen(ARG0)-strlen('normals.gp')].'common.gp' ARG1
table = folder.'normals.csv'
marked = 6  # the neighbourhood that the paper settles on

charts = folder.'normals_charts.csv'
panels = 0
stats charts using (panels = panels + (strcol('chart') eq 'normals'), 0) nooutput
array zones[panels]  # the first lines of the table
array titles[panels]
stats charts using (int($0) < panels ? (zones[int($0)+1] = strcol('zone'), 0) : NaN) nooutput
@texts
stats charts using (int($0) < panels ? (titles[int($0)+1] = strcol(2), 0) : NaN) nooutput
@tables
@find_methods

# A logarithm has no place for zero, and what is under a hundredth of a degree is as good.
error(deg) = deg < 0.01 ? 0.01 : deg
ns_of(zone, method) = strcol('zone') eq zone && strcol('method') eq method ? column('ns_per_normal') : NaN

cells = panels + 1  # the legend has one
columns = cells < 2 ? 1 : cells <= 4 ? 2 : cells <= 9 ? 3 : 4
lines = (cells + columns - 1) / columns
set terminal pngcairo size 420*columns,330*lines+60 @look
stats table using (column('ns_per_normal')) nooutput
set xrange [STATS_min/1.4:STATS_max*1.4]
set logscale xy
@normal_tics
array least[panels]
array most[panels]
do for [p=1:panels] {
  stats table using (strcol('zone') eq zones[p] ? error(column('mae_deg')) : NaN) nooutput
  least[p] = STATS_min / 1.3
  most[p] = STATS_max * 1.3
}

set multiplot layout lines,columns \
  title 'Mean error of a contact normal, degrees, against its time on one thread'.(columns > 2 ? '; ' : \
  "\n").sprintf('NS rises from left to right, large marks: NS = %d', marked) font 'sans,14'
set key off
set lmargin 6; set rmargin 1.5; set tmargin 2.4; set bmargin 2.4
do for [p=1:panels] {
  set title titles[p] font 'sans,11' @black offset 0,-0.4
  set yrange [least[p]:most[p]]
  plot for [m in backwards(found)] table using (ns_of(zones[p], m)):(error(column('mae_deg'))) \
    with linespoints ls style(m) ps 0.5, \
       for [m in backwards(found)] table using (ns_of(zones[p], m)):(column('ns') == marked ? \
         error(column('mae_deg')) : NaN) with points ls style(m) ps 1.7
}
unset title; unset border; unset tics; unset grid; unset logscale
set xrange [0:1]; set yrange [0:1]
set key center center Left reverse samplen 5 spacing 1.4 font 'sans,13' @black
plot for [m in found] 2 with linespoints ls style(m) ps 1.5 title m
unset multiplot
