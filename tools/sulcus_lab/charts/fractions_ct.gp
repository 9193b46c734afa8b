# How large the errors on a CT are (fractions_ct.csv): the share of its surface voxels against the error
# of the fitted surface, at the left, and of its normal, at the right. Above against the surface through
# the grey values, below against that of the smoothed ones, which fractions are made from.
call ARG0[1:strlen(ARG0)-strlen('fractions_ct.gp')].'common.gp' ARG1
table = folder.'fractions_ct.csv'

quantities = 'offset_error_voxels normal_error_deg'
truths = 'through smoothed'
shown(v) = strcol('quantity') eq quantity && strcol('truth') eq truth ? v : NaN

set terminal pngcairo size 1400,820 @look
set key top right samplen 1.5 spacing 1.2 font 'sans,11' @black
set yrange [0:*]
set multiplot layout 2,2 margins 0.06,0.98,0.08,0.94 spacing 0.08,0.16
do for [t=1:2] {
  do for [q=1:2] {
    truth = word(truths, t)
    quantity = word(quantities, q)
    set title (t == 1 ? 'Against the surface through the grey values' : \
      'Against the surface of the smoothed grey values') font 'sans,13' @black
    set xlabel (q == 1 ? 'how much too far out the fitted surface lies, voxels' : \
      'error of its normal, degrees') @dark
    set ylabel (q == 1 ? 'surface voxels, %' : '') @dark
    set xrange [(q == 1 ? -0.5 : 0):(q == 1 ? 0.5 : 24)]
    plot table using (shown(column('from'))):'binary' with fillsteps fs transparent solid 0.2 \
        lc rgb word(label_colours, 2) notitle, \
      table using (shown(column('from'))):'fractions' with fillsteps fs transparent solid 0.2 \
        lc rgb word(label_colours, 1) notitle, \
      table using (shown(column('from'))):'binary' with steps ls 22 title 'binary', \
      table using (shown(column('from'))):'fractions' with steps ls 21 title 'fractions'
  }
}
unset multiplot
