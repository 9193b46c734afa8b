# What all charts share. A chart reads the tables that its command has written, and is drawn anew by
#   gnuplot -c tools/sulcus_lab/charts/ticks.gp out/lab/ticks > ticks.png
# Each begins with a call of this file, with the folder (ARG1).

# Never a name that begins with '<' or '|', which gnuplot would run.
folder = (ARG1[1:1] eq '/' ? '' : './').ARG1.'/'
tables = "set datafile separator comma; set datafile columnheaders"
arrays = "set datafile separator whitespace; unset datafile columnheaders"  # before arrays are read
# Before texts are read, which may hold commas: the quoted cell of a line is then its second column,
# or its first where the line begins with it.
texts = "set datafile separator '\"'"
@tables
set datafile missing NaN  # a line goes on over what is left out

# set terminal pngcairo size WIDTH,HEIGHT @look
look = "rounded noenhanced font 'sans,11' background '#ffffff'"
frame = "set border 3 lc rgb '#666666'; set tics nomirror tc rgb '#222222'; set xtics nomirror; ".\
        "set ytics nomirror; set grid xtics ytics lw 1 lc rgb '#d8d8d8'"
@frame
# Colours of text, after what is set:  set title 'A title' @black
black = "tc rgb '#111111'"
dark = "tc rgb '#222222'"
grey = "tc rgb '#444444'"

# A list is a text, each word after a blank.
has(list, word) = strstrt(list.' ', ' '.word.' ') > 0
with_word(list, word) = has(list, word) ? list : list.' '.word
place_in(list, word) = words(list[1:strstrt(list.' ', ' '.word.' ')]) + 1
spaced(name) = strstrt(name, '_') ? spaced(name[1:strstrt(name, '_')-1].' '.name[strstrt(name, '_')+1:*]) : \
  name

# Methods of a normal, line styles 1 to 8: Okabe and Ito's blue and vermilion for ours, told apart by
# every kind of colour vision; the others muted; each with a mark of its own.
normal_methods = ' ldm ldm_fast ldm_paper weighted_sum weighted_sum_d2 pca mls exact'
normal_colours = ' #0072b2 #d55e00 #444444 #9a9a9a #9a9a9a #7fa88f #a78bb8 #b59a5b'
set style line 1 lw 3.5 pt 7 lc rgb word(normal_colours, 1)
set style line 2 lw 3.5 pt 5 lc rgb word(normal_colours, 2)
set style line 3 lw 1.8 pt 9 lc rgb word(normal_colours, 3)
set style line 4 lw 1.8 pt 1 lc rgb word(normal_colours, 4)
set style line 5 lw 1.8 pt 2 lc rgb word(normal_colours, 5) dt '-'
set style line 6 lw 1.8 pt 13 lc rgb word(normal_colours, 6)
set style line 7 lw 1.8 pt 11 lc rgb word(normal_colours, 7)
set style line 8 lw 1.8 pt 3 lc rgb word(normal_colours, 8)
style(method) = place_in(normal_methods, method)
colour(method) = word(normal_colours, style(method))

# Methods of contact, line styles 11 to 16.
contact_methods = ' coupling smooth count none mcneely single_point'
contact_colours = ' #0072b2 #d55e00 #009e73 #555555 #e69f00 #cc79a7'
set style line 11 lw 3.0 pt 7 lc rgb word(contact_colours, 1)
set style line 12 lw 2.2 pt 5 lc rgb word(contact_colours, 2)
set style line 13 lw 1.8 pt 9 lc rgb word(contact_colours, 3)
set style line 14 lw 1.8 pt 13 lc rgb word(contact_colours, 4)
set style line 15 lw 1.8 pt 11 lc rgb word(contact_colours, 5)
set style line 16 lw 1.8 pt 3 lc rgb word(contact_colours, 6)
contact_style(method) = 10 + place_in(contact_methods, method)
contact_colour(method) = word(contact_colours, place_in(contact_methods, method))

# Line styles 21 to 25: of what has no method, in turn.
label_colours = ' #0072b2 #d55e00 #009e73 #cc79a7 #e69f00'
set style line 21 lw 2.2 pt 5 lc rgb word(label_colours, 1)
set style line 22 lw 2.2 pt 7 lc rgb word(label_colours, 2)
set style line 23 lw 2.2 pt 9 lc rgb word(label_colours, 3)
set style line 24 lw 2.2 pt 11 lc rgb word(label_colours, 4)
set style line 25 lw 2.2 pt 13 lc rgb word(label_colours, 5)

# The words of a list without its first, or in turn from its last; what of `all` is in `seen`.
rest(list) = list[strlen(word(list, 1))+2:*]
backwards(list) = words(list) == 0 ? '' : backwards(rest(list)).' '.word(list, 1)
in_order(all, seen) = words(all) == 0 ? '' : (has(seen, word(all, 1)) ? ' '.word(all, 1) : \
  '').in_order(rest(all), seen)
# The methods in `table`:  @find_methods  sets `found`.
find_methods = "seen = ''; stats table using (seen = with_word(seen, strcol('method')), 0) nooutput; ".\
               "found = in_order(normal_methods.contact_methods, seen)"
# Tics of the time of a normal, decades and their thirds, so that a narrow panel has a few labels
# too, and of its error.
normal_tics = "set xtics ('10 ns' 10, '30' 30, '100 ns' 100, '300' 300, '1 us' 1e3, '3' 3e3, ".\
              "'10 us' 1e4, '30' 3e4, '100 us' 1e5, '300' 3e5, '1 ms' 1e6); ".\
              "set ytics ('<0.01' 0.01, '0.02' 0.02, '0.05' 0.05, '0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '1' 1, ".\
              "'2' 2, '3' 3, '5' 5, '10' 10, '15' 15, '20' 20, '30' 30, '45' 45, '90' 90)"

# Tics of a logarithmic axis that any reader can read off: 1, 2 and 5 of each decade, over more than
# two of them 1 and 3. `axis`, `low` and `high` set, then  @plain_log_tics
plain_log_tics = "eval 'set '.axis.'tics ('.log_tics(low, high).')'"
step_of(i, wide) = wide ? (int(i) % 2 ? 3 : 1) : (int(i) % 3 == 0 ? 1 : int(i) % 3 == 1 ? 2 : 5)
tic_of(i, wide) = step_of(i, wide) * 10.0**(int(i) / (wide ? 2 : 3) - 4)
tic_text(value, low, high) = value < 0.99*low || value > 1.01*high ? '' : sprintf(", '%g' %g", value, value)
tics_from(i, wide, low, high) = i > 11*(wide ? 2 : 3) ? '' : \
  tic_text(tic_of(i, wide), low, high).tics_from(i+1, wide, low, high)
log_tics(low, high) = tics_from(0, high > 100*low, low, high)[3:*]
