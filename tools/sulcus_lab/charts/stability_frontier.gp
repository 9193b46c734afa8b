# How stiff the tooth can be felt (stability_frontier.csv): contacts against felt stiffness, a frame
# for each method with the others' behind it in grey. Solid the least that holds, dashed the largest
# before buzz, filled between them where a method can be used.
call ARG0[1:strlen(ARG0)-strlen('stability_frontier.gp')].'common.gp' ARG1
table = folder.'stability_frontier.csv'

@find_methods
methods = words(found)
finite(name) = strcol(name) eq 'inf' || column(name) <= 0 ? NaN : column(name)
stats table using (finite('contacts')) name 'x' nooutput
stats table using (finite('felt_hold_N_per_mm')) name 'hold' nooutput
stats table using (finite('felt_buzz_N_per_mm')) name 'buzz' nooutput
x_low = x_min/1.5; x_high = x_max*1.5
y_low = (hold_min < buzz_min ? hold_min : buzz_min)/1.5
y_high = (hold_max > buzz_max ? hold_max : buzz_max)*1.5
# What is 0 or has no end lies on the frame's edge.
inside(name) = strcol(name) eq 'inf' || column(name) > y_high ? y_high : column(name) < y_low ? y_low : \
  column(name)
at(m) = strcol('method') eq m ? column('contacts') : NaN
array titles[methods]  # before there are ranges, which would limit what is counted
do for [i=1:methods] {
  usable = 0; measured = 0
  stats table using (strcol('method') eq word(found, i) ? \
    (measured = measured + 1, usable = usable + (inside('felt_hold_N_per_mm') < \
    inside('felt_buzz_N_per_mm')), 0) : NaN) nooutput
  titles[i] = spaced(word(found, i)).(usable == 0 ? ': nowhere' : usable == measured ? ': everywhere' : \
    ': where filled')
}

columns = methods < 3 ? methods : 3
wide = columns*460 + 40
tall = 90 + (methods + columns - 1)/columns*380
across(pixels) = pixels/(1.0*wide)
up(pixels) = 1 - pixels/(1.0*tall)
set terminal pngcairo size wide,tall @look
set multiplot
set label 1 'Where a method can be used: stiff enough to hold the push, and not yet buzzing' at screen \
  across(70),up(26) left font 'sans,14' @black
set lmargin at screen across(70); set rmargin at screen across(wide - 30); set bmargin at screen 0; \
  set tmargin at screen up(42)
set key at screen across(70),up(42) left top Left reverse horizontal samplen 4 width 2 font 'sans,11' @black
unset border; unset tics; unset grid
set xrange [0:1]; set yrange [0:1]
plot 2 with linespoints lw 2.5 lc rgb '#333333' pt 7 ps 0.9 title 'the least that holds', \
     2 with linespoints lw 2.5 lc rgb '#333333' dt '-' pt 6 ps 0.9 title 'the largest before buzz', \
     NaN with boxes fs solid 0.3 noborder lc rgb '#333333' title 'can be used', \
     2 with lines lw 1 lc rgb '#bbbbbb' title 'other methods'
set key off
unset label 1
@frame
set logscale xy
set xrange [x_low:x_high]; set yrange [y_low:y_high]
axis = 'x'; low = x_low; high = x_high
@plain_log_tics
axis = 'y'; low = y_low; high = y_high
@plain_log_tics
do for [i=1:methods] {
  m = word(found, i)
  left = 75 + 460*((i - 1) % columns); top = 110 + 380*((i - 1)/columns)
  set lmargin at screen across(left); set rmargin at screen across(left + 370)
  set bmargin at screen up(top + 280); set tmargin at screen up(top)
  set label 2 titles[i] at screen across(left),up(top - 13) left font 'sans,12' @black
  set xlabel 'voxels in contact' offset 0,0.4 @dark
  if (i % columns == 1 || columns == 1) { set ylabel 'felt stiffness, N/mm' offset 1,0 @dark } else \
    { unset ylabel }
  plot for [other in found] table using (at(other)):(inside('felt_buzz_N_per_mm')) smooth unique with lines \
    lw 1 lc rgb '#cccccc' dt '-', \
       for [other in found] table using (at(other)):(inside('felt_hold_N_per_mm')) smooth unique with lines \
         lw 1 lc rgb '#cccccc', \
       table using (at(m)):(inside('felt_hold_N_per_mm')):(inside('felt_buzz_N_per_mm')) with filledcurves \
         below fs transparent solid 0.18 noborder lc rgb contact_colour(m), \
       table using (at(m)):(inside('felt_buzz_N_per_mm')) smooth unique with linespoints dt '-' pt 6 ps 0.9 \
         lw 2.5 lc rgb contact_colour(m), \
       table using (at(m)):(inside('felt_hold_N_per_mm')) smooth unique with linespoints pt 7 ps 0.9 lw 2.5 \
         lc rgb contact_colour(m)
}
unset multiplot
