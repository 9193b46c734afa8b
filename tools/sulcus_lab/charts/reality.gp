# Rates of removal against load and speed under each law, with what was published
# (reality_curves.csv).
call ARG0[1:strlen(ARG0)-strlen('reality.gp')].'common.gp' ARG1
table = folder.'reality_curves.csv'

is(name, against) = strcol('series') eq name && strcol('against') eq against
at(name, against) = is(name, against) ? column('mm3_per_s') : NaN

set terminal pngcairo size 1200,560 @look
set multiplot layout 1,2
set logscale y
axis = 'y'; low = 0.02; high = 6
set yrange [low:high]
@plain_log_tics
set ylabel 'removed, mm3/s' @dark
set key top left Left reverse samplen 1.5 font 'sans,10' @black
set xlabel 'load, N' @dark
set xrange [0:3.2]
set title 'Enamel, turbine, burr of 1 mm, against the load' font 'sans,13' @black
plot table using 'x':(at('paper', 'load_N')) with linespoints ls 25 ps 1 title 'paper', \
     '' using 'x':(at('saturating carbide', 'load_N')) with linespoints ls 24 ps 2.2 \
       title 'saturating, carbide', \
     '' using 'x':(at('saturating medium', 'load_N')) with linespoints ls 21 ps 1 \
       title 'saturating, medium grit', \
     '' using 'x':(at('saturating coarse', 'load_N')) with linespoints ls 22 ps 1 \
       title 'saturating, coarse grit', \
     '' using 'x':(at('published', 'load_N')) with points pt 3 ps 2 lw 2 lc rgb '#111111' \
       title 'published', \
     '' using 'x':(at('published', 'load_N')):'label' with labels left offset 1,0 \
       font 'sans,10' @black notitle
set xlabel 'speed held, 1,000 rpm' @dark
set xrange [0:420]
set title 'The same at 1 N, against the speed' font 'sans,13' @black
set arrow 1 from 200,graph 0 to 200,graph 1 nohead lw 1.5 dt '-' lc rgb '#555555'
set label 1 'carbide F57 cuts most here' at 204,graph 0.04 left font 'sans,10' @grey
plot table using 'x':(at('paper', 'speed_krpm')) with linespoints ls 25 ps 1 title 'paper', \
     '' using 'x':(at('saturating carbide', 'speed_krpm')) with linespoints ls 24 ps 2.2 \
       title 'saturating, carbide', \
     '' using 'x':(at('saturating medium', 'speed_krpm')) with linespoints ls 21 ps 1 \
       title 'saturating, medium grit', \
     '' using 'x':(at('saturating coarse', 'speed_krpm')) with linespoints ls 22 ps 1 \
       title 'saturating, coarse grit'
unset multiplot
