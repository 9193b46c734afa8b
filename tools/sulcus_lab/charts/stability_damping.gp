# The largest stable stiffness under some damping (stability_damping.csv), a line for each loop. What
# is 0 or has no end lies on the frame's edge, with a ring.
call ARG0[1:strlen(ARG0)-strlen('stability_damping.gp')].'common.gp' ARG1
table = folder.'stability_damping.csv'

stats table using 0 nooutput
array loop[STATS_records]  # of each line
array loops[STATS_records]
lines = 0
@texts
stats table using (loop[int($0)+1] = strcol(1), lines == 0 || loops[lines] ne strcol(1) ? \
  (lines = lines + 1, loops[lines] = strcol(1), 0) : 0) nooutput
@tables
stiffness(v) = strcol('largest_stable_N_per_mm') eq 'inf' ? 1e99 : column('largest_stable_N_per_mm')
stats table using (stiffness(0) > 0 && stiffness(0) < 1e99 ? stiffness(0) : NaN) name 'y' nooutput
if (!exists('y_min')) { y_min = 0.15; y_max = 10/1.5 }
low = y_min/1.5; high = y_max*1.5
inside(v) = v < low ? low : v > high ? high : v
stats table using 'damping_N_s_per_m' name 'x' nooutput
of(l, v) = loop[int(column(0))+1] eq loops[l] ? v : NaN

set terminal pngcairo size 1200,640 @look
set logscale y
set yrange [low:high]
axis = 'y'
@plain_log_tics
set xrange [0:(x_max > 0 ? 1.03*x_max : 1)]
set xlabel 'damping, N s/m' @dark
set ylabel 'largest stable stiffness, N/mm' @dark
set title 'How damping moves the largest stable stiffness' font 'sans,14' @black
set key outside right top Left reverse samplen 3 spacing 1.5 font 'sans,11' @black
set label 1 'A ring: beyond the frame, none or all that were tried' at graph 0,-0.15 left font 'sans,10' @grey
set bmargin 5.5
looks(l) = 21 + (l - 1) % 5
dash(l) = l > 5 ? '-' : 1
plot for [l=1:lines] table using (of(l, column('damping_N_s_per_m'))):(inside(stiffness(0))) \
  with linespoints ls looks(l) ps 1.2 dt dash(l) title spaced(loops[l]), \
     for [l=1:lines] table using (of(l, column('damping_N_s_per_m'))):(stiffness(0) == inside(stiffness(0)) \
       ? NaN : inside(stiffness(0))) with points ls looks(l) pt 6 ps 2.2 lw 2 notitle
