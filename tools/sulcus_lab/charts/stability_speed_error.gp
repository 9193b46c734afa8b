# What a method's tick costs, and how wrong its force is (stability_speed_error.csv): a mark for each
# run, those of a method joined. An error of 0 lies on the frame's edge.
call ARG0[1:strlen(ARG0)-strlen('stability_speed_error.gp')].'common.gp' ARG1
table = folder.'stability_speed_error.csv'

@find_methods
error(e) = strcol('force_error_percent') eq 'inf' ? 1e99 : column('force_error_percent')
stats table using (column('tick_us') > 0 ? column('tick_us') : NaN) name 'x' nooutput
stats table using (error(0) > 0 && error(0) < 1e99 ? error(0) : NaN) name 'y' nooutput
x_low = x_min/1.5; x_high = x_max*1.5
y_low = y_min/1.5; y_high = y_max*1.5
inside(e) = e < y_low ? y_low : e > y_high ? y_high : e

set terminal pngcairo size 1200,640 @look
set logscale xy
set xrange [x_low:x_high]; set yrange [y_low:y_high]
axis = 'x'; low = x_low; high = x_high
@plain_log_tics
axis = 'y'; low = y_low; high = y_high
@plain_log_tics
set xlabel 'time of a tick, us, one thread' @dark
set ylabel 'error of the force, %' @dark
set title 'Speed and error of the force, from the same runs: better is further down and to the left' \
  font 'sans,14' @black
set key outside right top Left reverse invert samplen 3 spacing 1.5 font 'sans,11' @black
plot for [m in backwards(found)] table using (strcol('method') eq m ? column('tick_us') : \
  NaN):(inside(error(0))) smooth unique with linespoints ls contact_style(m) lw 1.4 ps 1.8 title spaced(m)
