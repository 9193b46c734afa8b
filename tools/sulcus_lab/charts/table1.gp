# Figs. 5 and 6 of [Kim and Park 2019] redrawn, of an experiment (ARG2): table1_EXPERIMENT.csv.
# Magnitudes of force and torque over the ticks, the reference in red over ours in blue, the analytic
# normals dashed where they are known, in narrow panels below each the difference, and the voxels in
# contact.
call ARG0[1:strlen(ARG0)-strlen('table1.gp')].'common.gp' ARG1
experiment = ARG2
table = folder.'table1_'.experiment.'.csv'

scaling = strstrt(experiment, '_smooth') ? 'smooth' : 'count'
title = (strstrt(experiment, 'probing') == 1 ? 'Probing' : \
  'Cutting').' along the central sulcus, scaling = '.scaling
truths = ''
stats table using (truths = truths.strcol('truth_force_N'), 0) nooutput
with_truth = strlen(truths) > 0
stats folder.'table1.csv' using (strcol('experiment') eq experiment && strcol('quantity') eq 'ticks' ? \
  column('ours') : NaN) name 'run' nooutput

# The next of 1, 2 and 5 times a power of ten.
power(v) = 10.0**floor(log10(v))
round_up(v) = v <= 0 ? 1 : v <= power(v) ? power(v) : v <= 2*power(v) ? 2*power(v) : v <= 5*power(v) ? \
  5*power(v) : 10*power(v)
# Largest and RMS difference, before there are ranges, which would limit what is counted.
array largest[2]
array rmse[2]
do for [i=1:2] {
  quantity = word('force_N torque_mNm', i)
  stats table using (column(quantity) - column('exact_'.quantity)) nooutput
  largest[i] = STATS_max > -STATS_min ? STATS_max : -STATS_min
  rmse[i] = sqrt(STATS_sumsq/STATS_records)
}

set terminal pngcairo size 1500,1150 @look
set multiplot title title @black
set grid xtics ytics lt 1 lw 1 lc rgb '#dddddd'
set lmargin at screen 0.07; set rmargin at screen 0.98
set format x ''
set xrange [0:run_max]
panel = "set bmargin at screen bottom; set tmargin at screen top; set ylabel label offset 1,0 @dark"
do for [part in 'force torque'] {
  quantity = part eq 'force' ? 'force_N' : 'torque_mNm'
  unit = part eq 'force' ? 'N' : 'mN m'
  upper = part eq 'force' ? 0.945 : 0.580
  set key on default right top horizontal samplen 3 @black
  set yrange [0:*]
  set ytics autofreq
  bottom = part eq 'force' ? 0.705 : 0.345; top = upper; label = part.', '.unit
  @panel
  plot table using 'tick':quantity with lines lw 4 lc rgb colour('ldm') title 'ldm', \
       table using 'tick':(column('exact_'.quantity)) with lines lw 1.2 lc rgb '#ff2020' \
         title 'exact, offline', \
       for [i=1:with_truth] table using 'tick':(column('truth_'.quantity)) with lines lw 1 dt (6,6) \
         lc rgb '#000000' title 'analytic normals'
  # From -limit to limit, so that the sign is seen; its key stands above it, in the gap.
  i = part eq 'force' ? 1 : 2
  limit = round_up(largest[i])
  bottom = bottom - 0.1; top = bottom + 0.08; label = 'ldm - exact'
  @panel
  set key on at screen 0.98,(top + 0.015) right top samplen 0
  set yrange [-limit:limit]
  set ytics (-limit, 0, limit)
  plot table using 'tick':(column(quantity) - column('exact_'.quantity)) with lines lw 1 lc rgb '#333333' \
    title sprintf('RMSE %.3g %s', rmse[i], unit)
}
set key off
set yrange [0:*]
set ytics autofreq
set format x '%.0f'
set xlabel 'tick' @dark
bottom = 0.055; top = 0.220; label = 'voxels in contact'
@panel
plot table using 'tick':'contacts' with lines lw 1 lc rgb '#333333'
unset multiplot
