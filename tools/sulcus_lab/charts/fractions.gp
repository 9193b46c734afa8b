# Binary surfaces and fractions against time (fractions_times.csv): an arrow for each row, from binary
# to fractions; errors of normals at the left, of forces at the right. Better is further down, faster
# further to the left.
call ARG0[1:strlen(ARG0)-strlen('fractions.gp')].'common.gp' ARG1
table = folder.'fractions_times.csv'

is_normal(v) = strcol('quantity') eq 'normal_error_deg'
is_force(v) = strcol('quantity') eq 'force_grain_pct' || strcol('quantity') eq 'force_peak_to_peak_pct' || \
  strcol('quantity') eq 'net_force_rms_pct'
shown(v, panel) = (panel == 1 ? is_normal(0) : is_force(0)) && column('binary') > 0 && column('fractions') > 0 ? \
  v : NaN
# Names of flat and gently bent surfaces, whose marks lie together, are moved apart.
apart(v, panel) = panel == 2 ? v : v*(column(0) == 0 ? 1.3 : column(0) == 4 ? 0.77 : 1)
larger(v, than) = v > than ? v : than  # than, where v is not a number
smaller(v, than) = v < than ? v : than
name_of(panel) = spaced(strcol('shape')).(strcol('setting') eq 'all' || strcol('quantity') eq 'force_grain_pct' || \
  strcol('quantity') eq 'net_force_rms_pct' ? '' : ', '.strcol('setting'))

set terminal pngcairo size 1400,680 @look
set logscale xy
set ytics ('0.001' 1e-3, '0.003' 3e-3, '0.01' 0.01, '0.03' 0.03, '0.1' 0.1, '0.3' 0.3, '1' 1, '3' 3, '10' 10, '30' 30, '100' 100)
set offsets graph 0.08, graph 0.3, graph 0.05, graph 0.05
set key outside top center horizontal samplen 1 font 'sans,11' @black
set style arrow 1 head filled size screen 0.008,20 lw 1.2 lc rgb '#888888'
set multiplot layout 1,2 margins 0.06,0.98,0.1,0.87 spacing 0.08
do for [panel=1:2] {
  set xtics ('30 ns' 30, '100 ns' 100, '300 ns' 300, '1 us' 1e3, '3 us' 3e3, '10 us' 1e4, '30 us' 3e4)
  if (panel == 2) { set xtics ('10 us' 1e4, '100 us' 1e5, '1 ms' 1e6, '10 ms' 1e7, '100 ms' 1e8) }
  set title (panel == 1 ? 'Mean error of the normal, degrees' : \
    'Error, swing and grain of the force, per cent') font 'sans,14' @black offset 0,1.2
  set xlabel (panel == 1 ? 'time of a normal' : 'time of an evaluation or a tick') @dark
  low = 1e9; high = 0
  stats table using (high = larger(shown(column('binary'), panel), high), \
    low = smaller(shown(column('fractions'), panel), low), 0) nooutput
  if (high > 0) {
    set yrange [low/2:high*2]
    plot table using (shown(column('binary_ns'), panel)):'binary':\
      (column('fractions_ns') - column('binary_ns')):(column('fractions') - column('binary')) \
      with vectors arrowstyle 1 notitle, \
      table using (shown(column('binary_ns'), panel)):'binary' with points ls 22 ps 1.5 title 'binary', \
      table using (shown(column('fractions_ns'), panel)):'fractions' with points ls 21 ps 1.5 title 'fractions', \
      table using (shown(column('fractions_ns'), panel)):(apart(column('fractions'), panel)):(name_of(panel)) \
      with labels left offset 1,0 font 'sans,9' @dark notitle
  } else { set multiplot next }
}
unset multiplot
