# gnuplot -c lobe.gnuplot NAME png|svg: draws NAME.FORMAT in the working folder from what reflectance_figures wrote there.
# Left: f_r as a lobe, its distance from the origin the value. Right: the cut through the plane of incidence, same unit.
# Source side (retro) to the right, specular side to the left in both.
load ARG1 . '.gnuplot'
if (ARG2 eq 'png') { set terminal pngcairo size 1120,520 font 'sans,12' } else { set terminal svg size 1120,520 font 'sans,12' }
set output name . '.' . ARG2
set encoding utf8
set angles degrees

lobe_file = name . '-' . files[1] . '-lobe.dat'
stats name . '-' . files[1] . '-cut.dat' using 3 nooutput
most = STATS_max
stats name . '-' . files[1] . '-cut.dat' using 4 nooutput
right = STATS_max; left = STATS_min
stats name . '-' . files[1] . '-cut.dat' using 6 nooutput
top = STATS_max
do for [k = 2:|files|] {
  stats name . '-' . files[k] . '-cut.dat' using 4 nooutput
  right = (STATS_max > right ? STATS_max : right); left = (STATS_min < left ? STATS_min : left)
  stats name . '-' . files[k] . '-cut.dat' using 6 nooutput
  top = (STATS_max > top ? STATS_max : top)
}
reach = 1.12 * (right > -left ? right : -left)
reach = (reach > 0.62 * top ? reach : 0.62 * top)
ray = 1.15 * most
high = 1.16 * (top > ray * cos(theta_i) ? top : ray * cos(theta_i))
reach = (reach > 1.12 * ray * sin(theta_i) ? reach : 1.12 * ray * sin(theta_i))

set multiplot title title_text . sprintf(', {/Symbol q}_i = %g°, {/Symbol f}_i = 0°', theta_i) font ',15' offset 0,-0.3
set palette defined (0 '#440154', 1 '#482878', 2 '#3e4a89', 3 '#31688e', 4 '#26828e', 5 '#1f9e89', 6 '#35b779', 7 '#6dcd59', 8 '#b4de2c', 9 '#fde725')

# The lobe.
set origin 0.0, 0.0; set size 0.52, 0.95
set lmargin at screen 0.02; set rmargin at screen 0.48; set bmargin at screen 0.16; set tmargin at screen 0.92
set view 62, 338, 1.25
set view equal xyz
set xyplane at 0
set xrange [-reach:reach]; set yrange [-reach:reach]; set zrange [0:high]
unset border; unset xtics; unset ytics; unset ztics; unset key
set cbrange [0:most]
set colorbox horizontal user origin 0.12, 0.1 size 0.26, 0.02
set cbtics most/4 font ',10' offset 0,0.4; set format cb '%.2g'; set cblabel 'f_r [sr^{-1}]' offset 0,0.9 font ',11'
set pm3d depthorder border lc rgb '#b0000000' lw 0.4
set pm3d lighting primary 0.35 specular 0.15
set isosamples 2
ring(n) = reach * n / 3.0
set arrow 1 from ray*sin(theta_i),0,ray*cos(theta_i) to most*0.02*sin(theta_i),0,most*0.02*cos(theta_i) head filled size screen 0.012,18 lw 2.5 lc rgb '#d62728' front
set arrow 2 from 0,0,0 to -ray*sin(theta_i),0,ray*cos(theta_i) nohead dt 2 lw 2 lc rgb '#d62728' front
set arrow 3 from 0,0,0 to 0,0,high nohead dt 3 lw 1 lc rgb '#555555' front
set label 1 'light, retro' at 1.08*ray*sin(theta_i),0,1.06*ray*cos(theta_i) center tc rgb '#d62728' font ',11' front
set label 2 'specular' at -1.25*ray*sin(theta_i),0,1.2*ray*cos(theta_i) center tc rgb '#d62728' font ',11' front
set label 3 '{/Symbol f}_r = 0°' at 0.98*reach,-0.12*reach,0 left tc rgb '#555555' font ',10'
set label 4 '180°' at -1.05*reach,0,0 right tc rgb '#555555' font ',10'
set parametric; set urange [0:360]; set vrange [0:1]
splot for [n = 1:3] ring(n)*cos(u), ring(n)*sin(u), 0 with lines lc rgb '#cccccc' lw 0.7 notitle, \
  lobe_file using 4:5:6:3 with pm3d notitle
unset parametric; unset pm3d; unset colorbox
unset arrow; unset label

# The cut, polar with the normal upwards.
set lmargin at screen 0.57; set rmargin at screen 0.985; set bmargin at screen 0.13; set tmargin at screen 0.8
set size ratio -1
set xrange [-reach:reach]; set yrange [0:high]
set xtics nomirror font ',10'; set ytics nomirror font ',10'; set border 3 front lc rgb '#888888'
set xlabel 'f_r sin {/Symbol q}_r [sr^{-1}];  left of 0: {/Symbol f}_r = 180°' font ',11'
set ylabel 'f_r cos {/Symbol q}_r [sr^{-1}]' font ',11'
set key at screen 0.98,0.9 right top Left reverse spacing 1.3 font ',11'
do for [a = 15:75:15] {
  long = (high/cos(a) < reach/sin(a) ? high/cos(a) : reach/sin(a))
  set arrow from 0,0 to long*sin(a),long*cos(a) nohead lc rgb '#dddddd' lw 0.7 back
  set arrow from 0,0 to -long*sin(a),long*cos(a) nohead lc rgb '#dddddd' lw 0.7 back
}
set arrow 101 from ray*sin(theta_i),ray*cos(theta_i) to 0,0 head filled size screen 0.01,18 lw 2 lc rgb '#d62728' front
set arrow 102 from 0,0 to -ray*sin(theta_i),ray*cos(theta_i) nohead dt 2 lw 2 lc rgb '#d62728' front
set label 101 'retro' at 1.03*ray*sin(theta_i),1.05*ray*cos(theta_i) center tc rgb '#d62728' font ',11' front
set label 102 'specular' at -1.03*ray*sin(theta_i),1.05*ray*cos(theta_i) center tc rgb '#d62728' font ',11' front
set linetype 11 lc rgb '#1f4e79' lw 2.5; set linetype 12 lc rgb '#e08214' lw 2.5 dt 2
plot for [k = 1:|files|] name . '-' . files[k] . '-cut.dat' using 4:6 with lines lt 10+k title legends[k]
unset multiplot
