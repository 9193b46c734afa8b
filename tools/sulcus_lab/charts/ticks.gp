# Time of a tick, and of one contact in it, against the contacts (ticks.csv, ticks_found.csv,
# ticks_floor.csv): a line for each method and cache with its fitted exponent, a millisecond, a
# quarter of one, PCA, and the floor.
call ARG0[1:strlen(ARG0)-strlen('ticks.gp')].'common.gp' ARG1
found_table = folder.'ticks_found.csv'

# Lines of ticks.csv and ticks_found.csv are of the same runs, in the same order.
stats folder.'ticks.csv' using 0 nooutput
rows = STATS_records
array us[rows]
array curve[rows]
stats folder.'ticks.csv' using (us[int($0)+1] = column('us_mean'), \
  curve[int($0)+1] = strcol('method').':'.strcol('cache'), 0) nooutput
array contacts[rows]
array pca[rows]
stats found_table using (contacts[int($0)+1] = column('contacts_mean'), pca[int($0)+1] = strcol('pca_us'), \
  0) nooutput
# What is measured once for a number of contacts stands at the first line of that number.
array wanted[rows]
seen = ''
stats found_table using (wanted[int($0)+1] = has(seen, strcol('contacts')) ? 0 : column('contacts'), \
  seen = with_word(seen, strcol('contacts')), 0) nooutput
array fresh_us[rows]
array kept_us[rows]
do for [i=1:rows] {
  fresh_us[i] = NaN; kept_us[i] = NaN
  if (wanted[i] > 0) {
    stats folder.'ticks_floor.csv' using (column('contacts') == wanted[i] ? \
      (strcol('cache') eq 'fresh' ? (fresh_us[i] = column('floor_us')) : (kept_us[i] = column('floor_us')), \
      0) : NaN) nooutput
  }
}

@arrays
curves = ''
do for [i=1:rows] { curves = with_word(curves, curve[i]) }
method_of(c) = c[1:strstrt(c, ':')-1]
cache_of(c) = c[strstrt(c, ':')+1:*]
of(c, i) = curve[i] eq c ? us[i] : NaN
pca_of(i) = wanted[i] > 0 && strlen(pca[i]) ? real(pca[i]) : NaN
exponent(name) = exists('STATS_records') && STATS_records > 1 ? name.sprintf(':  n^{%.2f}', STATS_slope) : \
  name

exponent(name) = exists('STATS_records') && STATS_records > 1 ? name.sprintf(':  n^{%.2f}', STATS_slope) : \
  name
array titles[words(curves)]
do for [c=1:words(curves)] {
  stats contacts using (log($2)):(log(of(word(curves, c), $1))) nooutput
  titles[c] = exponent(spaced(method_of(word(curves, c))).' '.cache_of(word(curves, c)))
}
stats contacts using (log($2)):(log(pca_of($1))) nooutput
with_pca = exists('STATS_records') && STATS_records > 0
pca_title = exponent('PCL PCA, the normals alone')
stats contacts using (log($2)):(log(fresh_us[$1])) nooutput
fresh_title = exponent('floor, fresh: bytes read')
stats contacts using (log($2)):(log(kept_us[$1])) nooutput
kept_title = exponent('floor, kept')

# Colours tell the method; dash and mark where the normals came from.
dash(c) = cache_of(c) eq 'fresh' ? 1 : cache_of(c) eq 'kept' ? '_' : '.'
mark(c) = cache_of(c) eq 'fresh' ? 7 : cache_of(c) eq 'kept' ? 5 : 9

set terminal pngcairo size 1600,640 @look
set termoption enhanced
set grid xtics ytics lc rgb '#c8c8c8' lw 1
stats contacts using 2 nooutput
set xrange [STATS_min/1.3:STATS_max*1.3]
set logscale xy
set xtics ('100' 100, '350' 350, '1,200' 1200, '4,000' 4e3, '10,000' 1e4, '30,000' 3e4, '100,000' 1e5)
set xlabel 'voxels in contact, n' @dark
set multiplot layout 1,2
set key off
set lmargin at screen 0.055; set rmargin at screen 0.405
set title 'Time of a tick, one thread' font 'sans,13' @black
set ytics ('0.1 us' 0.1, '1 us' 1, '10 us' 10, '100 us' 100, '1 ms' 1e3, '10 ms' 1e4, '100 ms' 1e5, '1 s' 1e6)
plot for [c in curves] contacts using 2:(of(c, $1)) with linespoints lw 2.5 ps 1.1 \
  lc rgb colour(method_of(c)) dt dash(c) pt mark(c), \
     contacts using 2:(pca_of($1)) with linespoints ls style('pca') ps 1.1, \
     contacts using 2:(fresh_us[$1]) with lines lw 2 lc rgb '#777777' dt solid, \
     contacts using 2:(kept_us[$1]) with lines lw 2 lc rgb '#777777' dt '_', \
     1000 with lines lw 1.5 lc rgb '#222222', 250 with lines lw 1.5 lc rgb '#222222' dt '-'
set lmargin at screen 0.455; set rmargin at screen 0.785
set key on at screen 0.795,0.90 left top Left reverse samplen 3 spacing 1.5 font 'sans,11' @black
set title 'The same for each contact' font 'sans,13' @black
set ytics ('1 ns' 1, '2' 2, '5' 5, '10 ns' 10, '20' 20, '50' 50, '100 ns' 100, '200' 200, '500' 500, \
  '1 us' 1e3, '2' 2e3, '5' 5e3, '10 us' 1e4, '20' 2e4)
plot for [i=1:words(curves)] contacts using 2:(1e3*of(word(curves, i), $1)/$2) with linespoints lw 2.5 ps \
  1.1 lc rgb colour(method_of(word(curves, i))) dt dash(word(curves, i)) pt mark(word(curves, i)) \
  title titles[i], \
     for [i=1:with_pca] contacts using 2:(1e3*pca_of($1)/$2) with linespoints ls style('pca') ps 1.1 \
       title pca_title, \
     contacts using 2:(1e3*fresh_us[$1]/$2) with lines lw 2 lc rgb '#777777' dt solid title fresh_title, \
     contacts using 2:(1e3*kept_us[$1]/$2) with lines lw 2 lc rgb '#777777' dt '_' title kept_title, \
     NaN with lines lw 1.5 lc rgb '#222222' title 'a tick at 1 kHz: 1 ms', \
       NaN with lines lw 1.5 lc rgb '#222222' dt '-' title 'a quarter of it'
unset multiplot
