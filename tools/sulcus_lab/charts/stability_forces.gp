# Force over time of a case's runs (ARG2), and below it the depth where that was measured:
# stability_CASE.csv. Up to five runs in one frame; of more a frame for each label, or for each method
# where there is one label only. Colour tells the method where there are several, dashes the label. A
# run that is far larger than most leaves the frame, and its largest force stands beside its name.
call ARG0[1:strlen(ARG0)-strlen('stability_forces.gp')].'common.gp' ARG1
table = folder.'stability_'.ARG2.'.csv'

# What the runs are, one a block of the table, and how far they go.
stats table using (runs = column('run') + 1, 0) nooutput
array method[runs]
array label[runs]
array low[runs]
array high[runs]
array forces[runs]
array depths[runs]
do for [r=1:runs] { low[r] = 0.0; high[r] = 0.0; forces[r] = 0; depths[r] = 0 }
seconds = 1e-3; deepest = 0.0; shallowest = 0.0
least(a, b) = b < a ? b : a
most(a, b) = b > a ? b : a
stats table using (r = int(column('run')) + 1, method[r] = strcol('method'), \
  seconds = most(seconds, column('time_s')), 0) nooutput
stats table using (r = int(column('run')) + 1, f = column('force_N'), forces[r] = 1, \
  low[r] = least(low[r], f), high[r] = most(high[r], f), f) nooutput
stats table using (r = int(column('run')) + 1, d = column('depth_mm'), depths[r] = 1, \
  deepest = most(deepest, d), shallowest = least(shallowest, d), d) nooutput
@texts
stats table using (label[int(strcol(1)[1:strstrt(strcol(1), ',')-1])+1] = strcol(2), 0) nooutput
@tables
seen = ''
do for [r=1:runs] { seen = with_word(seen, method[r]) }
found = in_order(contact_methods, seen)
methods = words(found)
array label_of[runs]  # its place among the labels
array labels[runs]
labels_n = 0
with_depth = 0
do for [r=1:runs] {
  label_of[r] = 0
  do for [l=1:labels_n] { if (labels[l] eq label[r]) { label_of[r] = l } }
  if (label_of[r] == 0) { labels_n = labels_n + 1; labels[labels_n] = label[r]; label_of[r] = labels_n }
  with_depth = with_depth || depths[r]
}

# All of the forces is shown, but where one is over twice as large as the middle one, up to that.
array peak[runs]
do for [r=1:runs] { peak[r] = most(high[r], -low[r]) }
@arrays
stats low using 2 name 'low' nooutput
stats high using 2 name 'high' nooutput
stats peak using 2 name 'peak' nooutput
@tables
middle = peak_max
do for [i=1:runs] {
  below = 0
  do for [j=1:runs] { below = below + (peak[j] <= peak[i]) }
  if (below > runs/2) { middle = least(middle, peak[i]) }
}
limit = middle > 0 ? 2*middle : peak_max
shown_low = most(low_min, -limit); shown_high = least(high_max, limit)
room = 0.06*(shown_high - shown_low)
if (peak_max == 0) { shown_low = 0.0; shown_high = 1.0; room = 0.0 }
if (shown_low < 0) { shown_low = shown_low - room }
shown_high = shown_high + room

# Frames, as lists of runs, the default method last, on top.
many = runs > 5
by_label = labels_n > 1
frames = !many ? 1 : by_label ? labels_n : methods
array members[frames]
array frame_title[frames]
do for [f=1:frames] {
  members[f] = ''
  frame_title[f] = !many ? '' : by_label ? labels[f] : spaced(word(found, f))
  do for [m in backwards(found)] {
    do for [r=1:runs] {
      if (method[r] eq m && (!many || (by_label ? label_of[r] == f : word(found, f) eq m))) \
        { members[f] = members[f].sprintf(' %d', r) }
    }
  }
}

# How a run is called where its frame does not say it, and what of it leaves the frame.
newtons(value) = sprintf('%.3g N', value)
name(r) = (methods > 1 || labels_n == 1 ? spaced(method[r]) : '').(by_label && !many ? \
  (methods > 1 ? ', ' : '').label[r] : '')
leaves(r) = (high[r] > shown_high ? 'up to '.newtons(high[r]) : '').(low[r] < shown_low ? \
  (high[r] > shown_high ? ', ' : '').'to '.newtons(low[r]) : '')
with_leaves(r) = strlen(leaves(r)) ? name(r).' ('.leaves(r).')' : name(r)
width(r) = methods > 1 ? word(' 3.0 2.2 1.8 1.8 1.8 1.8', place_in(contact_methods, method[r])) : 2.2
colour_of(r) = methods > 1 || many ? contact_colour(method[r]) : \
  word(label_colours, (label_of[r] - 1) % 5 + 1)
dash_of(l) = l == 1 ? 1 : l == 2 ? '-' : l == 3 ? '.' : l == 4 ? '_.' : '_ '
dash(r) = methods > 1 && !many ? dash_of((label_of[r] - 1) % 5 + 1) : 1

# Sizes in pixels, heights from the top.
columns = frames == 1 ? 1 : frames <= 4 ? 2 : 3
with_key = many && methods > 1 && by_label  # small frames share one key, unless each says its method
wide = 1400
head = with_key ? 78 : many ? 48 : 64
depth_high = !with_depth ? 0 : many ? 110 : 180
row_high = (many ? 300 : 420) + depth_high
tall = head + (frames + columns - 1)/columns*row_high
across(pixels) = pixels/(1.0*wide)
up(pixels) = 1 - pixels/(1.0*tall)
margins = \
  "set lmargin at screen across(left); set rmargin at screen across(right); ".\
  "set bmargin at screen up(bottom); set tmargin at screen up(top)"

per_second = seconds < 0.5 ? 1e3 : 1.0
time_label = 'time, '.(seconds < 0.5 ? 'ms' : 's')
set terminal pngcairo size wide,tall @look
set multiplot
set key off
set label 1 'Force over time: '.spaced(ARG2) at screen across(70),up(26) left font 'sans,14' @black
if (with_key) {
  left = 70; right = wide - 30; bottom = tall; top = 42
  @margins
  set key on at screen across(left),up(top) left top Left reverse horizontal samplen 4 width 2 \
    font 'sans,11' @black
  unset border; unset tics; unset grid
  set xrange [0:1]; set yrange [0:1]
  plot for [m in found] 2 with lines ls contact_style(m) title spaced(m)
  set key off
  unset label 1
  @frame
}
set xrange [0:seconds*per_second]
do for [f=1:frames] {
  tile = (wide - 30)/columns
  left = 70 + tile*((f - 1) % columns)
  right = left + tile - 80 - (many ? 0 : 330)
  top = head + row_high*((f - 1)/columns) + (many ? 26 : 0)
  bottom = top + row_high - (many ? 26 : 0) - 66 - depth_high
  @margins
  gone = ''; with_force = ''; depth_runs = ''
  do for [r in members[f]] {
    if (strlen(leaves(int(r)))) { gone = gone.(strlen(gone) ? '; ' : '').(strlen(name(int(r))) ? \
      name(int(r)) : label[int(r)]).' '.leaves(int(r)) }
    if (forces[int(r)]) { with_force = with_force.' '.r }
    if (depths[int(r)]) { depth_runs = depth_runs.' '.r }
  }
  if (many) {
    set label 2 frame_title[f] at screen across(left),up(top - 12) left font 'sans,12' @black
    set label 3 gone at screen across(right),up(top - 11) right font 'sans,9' @grey front
  } else {
    set key on at screen across(right + 20),up(top) left top Left reverse samplen 3 spacing 1.5 \
      font 'sans,11' @black
  }
  set yrange [shown_low:shown_high]
  set ytics autofreq
  set ylabel 'force, N' offset 1,0 @dark
  if (strlen(depth_runs)) { set format x ''; unset xlabel } else \
    { set format x '%g'; set xlabel time_label offset 0,0.4 @dark }
  # A frame with no force is drawn empty, so that its depth keeps its place.
  plot NaN notitle, for [r in with_force] table using (column('time_s')*per_second):'force_N' every \
    :::int(r)-1::int(r)-1 with lines lw width(int(r)) lc rgb colour_of(int(r)) dt dash(int(r)) \
    title with_leaves(int(r))
  unset label
  if (strlen(depth_runs)) {
    # Downwards, as the tool goes.
    span = most(deepest - shallowest, 1e-3); room = 0.08*span
    top = bottom + 14; bottom = bottom + depth_high
    @margins
    set key off
    set yrange [deepest+room:shallowest-(shallowest < 0 ? room : 0)]
    decade = 10.0**floor(log10(span/5))
    step = decade*(5*decade < span/5 ? 10 : 2*decade < span/5 ? 5 : decade < span/5 ? 2 : 1)
    set ytics step
    set ylabel 'depth, mm' offset 1,0 @dark
    set format x '%g'; set xlabel time_label offset 0,0.4 @dark
    plot for [r in depth_runs] table using (column('time_s')*per_second):'depth_mm' every \
      :::int(r)-1::int(r)-1 with lines lw width(int(r)) lc rgb colour_of(int(r)) dt dash(int(r)) notitle
  }
}
unset multiplot
