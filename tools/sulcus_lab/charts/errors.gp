# Errors on a shape (ARG2) as in figs. 9 and 10 of [Kim and Park 2019]: errors_SHAPE.csv, a row of
# tiles per method and a column per neighbourhood.
call ARG0[1:strlen(ARG0)-strlen('errors.gp')].'common.gp' ARG1
shape = ARG2
table = folder.'errors_'.shape.'.csv'
tile = 160  # pixels along an edge
largest = 6

seen = ''
sizes = ''
zone(name) = name eq shape || name eq 'all'
stats folder.'normals.csv' using (zone(strcol('zone')) && column('ns') <= largest ? \
  (seen = with_word(seen, strcol('method')), sizes = with_word(sizes, strcol('ns')), 0) : NaN) nooutput
found = in_order(normal_methods, seen)
sizes = in_order(' 1 2 3 4 5 6', sizes)
lines = words(found)
columns = words(sizes)
# Which tiles there are: a slow method has not all.
tiles = ''
stats folder.'normals.csv' using (zone(strcol('zone')) && column('ns') <= largest ? \
  (tiles = with_word(tiles, strcol('method').'_'.strcol('ns')), 0) : NaN) nooutput

left = 175; right = 110; top = 70; bottom = 15
width = columns*tile + left + right
height = lines*tile + top + bottom
set terminal pngcairo size width,height @look
set title 'Error of the normals on the '.spaced(shape).', degrees' offset 0,1.6 font 'sans,15' @black
do for [c=1:columns] { set label 'NS = '.word(sizes, c) at (c - 0.5)*tile,lines*tile + 12 center \
  font 'sans,13' @black }
do for [l=1:lines] { set label word(found, l) at -8,(lines - l + 0.5)*tile right font 'sans,13' @black }
unset border; unset tics; unset grid
set key off
set lmargin at screen left/(1.0*width); set rmargin at screen (left + columns*tile)/(1.0*width)
set bmargin at screen bottom/(1.0*height); set tmargin at screen (bottom + lines*tile)/(1.0*height)
set xrange [-0.5:columns*tile-0.5]
set yrange [-0.5:lines*tile-0.5]
# Viridis, light for little: equal steps for every eye, and grey prints keep the order.
set palette defined (0 '#fde725', 1 '#a0da39', 2 '#4ac16d', 3 '#1fa187', 4 '#277f8e', 5 '#365c8d', \
  6 '#46327e', 7 '#440154')
set logscale cb
set cbrange [0.1:90]
set cbtics ('0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '1' 1, '2' 2, '5' 5, '10' 10, '20' 20, '45' 45, '90' 90) @black
unset datafile missing  # an image has all its pixels
shown(t) = column(t) < 0.1 ? 0.1 : column(t)
method_of(t) = t[1:strlen(t)-2]
x_of(t) = (place_in(sizes, t[strlen(t):*]) - 1)*tile
y_of(t) = (lines - place_in(found, method_of(t)))*tile
plot for [t in tiles] table using (column('x') + x_of(t)):(column('y') + y_of(t)):(shown(t)) with image
