# Where the time of a tick goes (ticks_stages.csv): bars of the stages of each contact
# (ticks_found.csv), for each method, cache and number.
call ARG0[1:strlen(ARG0)-strlen('ticks_stages.gp')].'common.gp' ARG1
table = folder.'ticks_stages.csv'

stats folder.'ticks_found.csv' using 0 nooutput
runs = STATS_records
array contacts[runs]
stats folder.'ticks_found.csv' using (contacts[int($0)+1] = column('contacts_mean'), 0) nooutput
# A run has a line for each stage, one after another: a bar from the sum before it to that with it,
# in ns a contact. Bars of a number of contacts stand together, with a gap after them.
stats table using 0 nooutput
array bar[STATS_records]
array low[STATS_records]
array high[STATS_records]
stages = ''; methods = ''
stats table using (stages = with_word(stages, strcol('stage')), \
  methods = with_word(methods, strcol('method')), 0) nooutput
per_run = words(stages)
array last[words(methods)]
array group[words(methods)]
do for [m=1:words(methods)] { last[m] = -2; group[m] = -1 }
next(m, number) = (sum = 0, last[m] = last[m] + (number == group[m] ? 1 : 2), group[m] = number)
stats table using (m = place_in(methods, strcol('method')), \
  int($0) % per_run == 0 ? next(m, column('contacts')) : 0, bar[int($0)+1] = last[m], low[int($0)+1] = sum, \
  sum = sum + 1e3*column('us_mean')/contacts[int($0)/per_run+1], high[int($0)+1] = sum, 0) nooutput

colours = '#56b4e9 #0072b2 #e69f00 #009e73 #cc79a7'
is(method, stage) = strcol('method') eq method && strcol('stage') eq stage
set terminal pngcairo size 1400,440*words(methods) @look
set grid noxtics
set style fill solid 1 noborder
set yrange [0:*]
set xtics rotate by 90 right font 'sans,9' scale 0
set ylabel 'ns for each contact' @dark
set key outside right top Left reverse invert samplen 1 spacing 1.4
set bmargin 6
set multiplot layout words(methods),1
do for [m in methods] {
  # The names below, and under those of a number of contacts that number.
  names = ''; numbers = ''; firsts = ''; end = 0
  stats table using (is(m, word(stages, 1)) ? (end = bar[int($0)+1], \
    names = names.sprintf("%s'%s' %d", strlen(names) ? ', ' : '', strcol('cache'), end), \
    firsts = has(numbers, strcol('contacts')) ? firsts : firsts.sprintf(' %d', end), \
      numbers = with_word(numbers, strcol('contacts')), 0) : NaN) nooutput
  do for [g=1:words(numbers)] {
    to = g < words(numbers) ? word(firsts, g+1) - 2 : end
    set label g word(numbers, g) at first 0.5*(word(firsts, g) + to), graph -0.24 center font 'sans,11' @black
  }
  eval 'set xtics ('.names.')'
  set xrange [-1:end+1]
  set title 'Where the time of a tick goes, '.spaced(m).': stages, by voxels in contact' font 'sans,13' @black
  plot for [s=per_run:1:-1] table using (is(m, word(stages, s)) ? bar[int($0)+1] : \
    NaN):(0.5*(low[int($0)+1]+high[int($0)+1])):(0.43):(0.5*(high[int($0)+1]-low[int($0)+1])) \
    with boxxyerror fs solid 1 noborder lc rgb word(colours, s) title spaced(word(stages, s))
  unset label
}
unset multiplot
