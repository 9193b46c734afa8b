# Time of a tick, as a multiple of that of the smallest, against the cells and the bodies
# (ticks_cells.csv, ticks_bodies.csv), with what it may be.
call ARG0[1:strlen(ARG0)-strlen('ticks_sweeps.gp')].'common.gp' ARG1

key_of(k) = strcol('method').':'.strcol('cache').':'.strcol('contacts')
part(key, i) = i == 1 ? key[1:strstrt(key, ':')-1] : part(key[strstrt(key, ':')+1:*].':', i - 1)
dash(key) = part(key, 2) eq 'fresh' ? 1 : part(key, 2) eq 'kept' ? '_' : '.'
mark(key) = part(key, 2) eq 'fresh' ? 7 : part(key, 2) eq 'kept' ? 5 : 9

set terminal pngcairo size 1400,560 @look
set grid xtics ytics lc rgb '#c8c8c8' lw 1
set logscale x 2
set yrange [0:1.6]
set multiplot layout 1,2
set ylabel 'time of a tick, to the first' @dark
set key bottom right Left reverse samplen 3 spacing 1.3 font 'sans,10'
do for [sweep in 'cells bodies'] {
  table = folder.'ticks_'.sweep.'.csv'
  limit = sweep eq 'cells' ? 1.3 : 1.1
  keys = ''; sizes = ''
  stats table using (keys = with_word(keys, key_of(0)), sizes = with_word(sizes, strcol(sweep)), 0) nooutput
  if (words(keys) > 0) {
    array first[words(keys)]
    stats table using (strcol(sweep) eq word(sizes, 1) ? \
      (first[place_in(keys, key_of(0))] = column('us_mean'), 0) : NaN) nooutput
    tics = ''
    do for [s in sizes] { tics = tics.(strlen(tics) ? ', ' : '').s }
    eval 'set xtics ('.tics.')'
    set xrange [word(sizes, 1)/1.2:word(sizes, words(sizes))*1.2]
    set title (sweep eq 'cells' ? 'The same contacts in larger grids' : 'One of several bodies touched') \
      font 'sans,13' @black
    set xlabel (sweep eq 'cells' ? 'cells along each axis' : 'bodies') @dark
    plot limit with lines lw 1.5 lc rgb '#222222' dt '-' title sprintf('at most %g', limit), \
         for [k=1:words(keys)] table using (key_of(0) eq word(keys, k) ? column(sweep) : \
           NaN):(column('us_mean')/first[k]) with linespoints lw 2.5 ps 1.1 \
           lc rgb colour(part(word(keys, k), 1)) dt dash(word(keys, k)) pt mark(word(keys, k)) \
         title sprintf('%s, %s, %s contacts: %.0f us', spaced(part(word(keys, k), 1)), \
           part(word(keys, k), 2), part(word(keys, k), 3), first[k])
  }
}
unset multiplot
