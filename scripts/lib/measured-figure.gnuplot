# gnuplot -c measured-figure.gnuplot NAME cut|rings png|svg TITLE: NAME.FORMAT in the working folder, of measured-figure-tables.
# Left: what was measured, as a body whose distance from the origin is f_r; directions in the detector's shadow are holes. Right: measured
# values with U (95.45 %) over the formula, and below how far they are from it in units of U.
name = ARG1; kind = ARG2
if (ARG3 eq 'png') { set terminal pngcairo size 1120,560 font 'sans,12' background rgb 'white' } else { set terminal svg size 1120,560 font 'sans,12' background rgb 'white' }
set output name . '.' . ARG3
set encoding utf8
set angles degrees
theta_i = 30.0
body = name . '-body.dat'; points = name . '-points.dat'; formula = name . '-formula.dat'
stats body using 4 nooutput; most = STATS_max
stats body using 1 nooutput; reach = 1.15 * (STATS_max > -STATS_min ? STATS_max : -STATS_min)
stats body using 3 nooutput; top = STATS_max
stats formula using 2 nooutput; most_formula = STATS_max
ray = 1.15 * most
high = 1.1 * (top > ray * cos(theta_i) ? top : ray * cos(theta_i))
reach = (reach > 1.12 * ray * sin(theta_i) ? reach : 1.12 * ray * sin(theta_i))
reach = (reach > 0.6 * high ? reach : 0.6 * high)

set multiplot title ARG4 . sprintf(', {/Symbol q}_i = %g°', theta_i) font ',15' offset 0,-0.3
set palette defined (0 '#440154', 1 '#482878', 2 '#3e4a89', 3 '#31688e', 4 '#26828e', 5 '#1f9e89', 6 '#35b779', 7 '#6dcd59', 8 '#b4de2c', 9 '#fde725')

set origin 0.0, 0.0; set size 0.5, 0.95
set lmargin at screen 0.02; set rmargin at screen 0.46; set bmargin at screen 0.16; set tmargin at screen 0.92
set view 62, 338, 1.2
set view equal xyz
set xyplane at 0
set xrange [-reach:reach]; set yrange [-reach:reach]; set zrange [0:high]
unset border; unset xtics; unset ytics; unset ztics; unset key
set cbrange [0:most]
set colorbox horizontal user origin 0.12, 0.1 size 0.24, 0.02
set cbtics most/4 font ',10' offset 0,0.4; set format cb '%.2g'; set cblabel 'f_r measured [sr^{-1}]' offset 0,0.9 font ',11'
set pm3d depthorder border lc rgb '#b0000000' lw 0.4
set pm3d lighting primary 0.35 specular 0.15
ring(n) = reach * n / 3.0
set arrow 1 from ray*sin(theta_i),0,ray*cos(theta_i) to most*0.02*sin(theta_i),0,most*0.02*cos(theta_i) head filled size screen 0.012,18 lw 2.5 lc rgb '#d62728' front
set arrow 2 from 0,0,0 to -ray*sin(theta_i),0,ray*cos(theta_i) nohead dt 2 lw 2 lc rgb '#d62728' front
set arrow 3 from 0,0,0 to 0,0,high nohead dt 3 lw 1 lc rgb '#555555' front
set label 1 'light, retro' at 1.08*ray*sin(theta_i),0,1.06*ray*cos(theta_i) center tc rgb '#d62728' font ',11' front
set label 2 'specular' at -1.25*ray*sin(theta_i),0,1.2*ray*cos(theta_i) center tc rgb '#d62728' font ',11' front
set label 3 '{/Symbol f}_r = 0°' at 0.98*reach,-0.12*reach,0 left tc rgb '#555555' font ',10'
set label 4 '180°' at -1.05*reach,0,0 right tc rgb '#555555' font ',10'
set parametric; set urange [0:360]; set vrange [0:1]; set isosamples 2
splot for [n = 1:3] ring(n)*cos(u), ring(n)*sin(u), 0 with lines lc rgb '#cccccc' lw 0.7 notitle, \
  body using 1:2:3:4 with pm3d notitle
unset parametric; unset pm3d; unset colorbox; unset arrow; unset label

set lmargin at screen 0.57; set rmargin at screen 0.985
set border 3 lc rgb '#888888'; set tics nomirror font ',10'; set grid lc rgb '#dddddd'
if (kind eq 'cut') {
  set xrange [-82:82]; set xtics 20; where = '{/Symbol q}_r in the plane of incidence [deg], negative: {/Symbol f}_r = 180°'
} else {
  set xrange [0:360]; set xtics 60; where = '{/Symbol f}_r - {/Symbol f}_i [deg]'
}
marks = (kind eq 'cut')
set bmargin at screen 0.42; set tmargin at screen 0.88
set yrange [0:1.3*most_formula]; set format x ''; set ylabel 'f_r [sr^{-1}]' font ',11'
set key at screen 0.7775,0.91 center center horizontal font ',10' samplen 1.5 width 1  # above the frame: marks cross nothing
if (marks) {
  set arrow 11 from theta_i, graph 0 to theta_i, graph 1 nohead dt 2 lc rgb '#d62728'; set arrow 12 from -theta_i, graph 0 to -theta_i, graph 1 nohead dt 3 lc rgb '#d62728'
  set label 11 'retro' at theta_i, graph 0.05 left offset 0.3,0 tc rgb '#d62728' font ',10'; set label 12 'specular' at -theta_i, graph 0.05 right offset -0.3,0 tc rgb '#d62728' font ',10'
  plot formula using 1:2 with lines lc rgb '#e08214' lw 2 title 'formula', points using 1:2:3 with yerrorbars pt 7 ps 0.5 lc rgb '#1f4e79' title 'measured, U'
} else {
  array colours[3] = ['#440154', '#26828e', '#9aa800']
  set arrow 11 from 0, graph 0 to 0, graph 1 nohead dt 2 lc rgb '#d62728'; set arrow 12 from 180, graph 0 to 180, graph 1 nohead dt 3 lc rgb '#d62728'
  set label 11 'retro' at 0, graph 0.05 left offset 0.3,0 tc rgb '#d62728' font ',10'; set label 12 'specular' at 180, graph 0.05 left offset 0.3,0 tc rgb '#d62728' font ',10'
  plot for [k = 0:2] formula index k using 1:2 with lines lc rgb colours[k+1] lw 1.5 title sprintf('table, {/Symbol q}_r = %d°', 30 + 15*k), \
    for [k = 0:2] points index k using 1:2:3 with yerrorbars pt 7 ps 0.5 lc rgb colours[k+1] notitle, \
    NaN with points pt 7 ps 0.5 lc rgb '#555555' title 'measured, U'
}
unset label; unset key
set bmargin at screen 0.12; set tmargin at screen 0.38
set format x '%g'; set xlabel where font ',11'; set ylabel 'difference / U' font ',11'
set yrange [-2:2]; set ytics 1
set arrow 13 from graph 0, first 1 to graph 1, first 1 nohead dt 2 lc rgb '#888888'; set arrow 14 from graph 0, first -1 to graph 1, first -1 nohead dt 2 lc rgb '#888888'
plot points using 1:4 with points pt 7 ps 0.5 lc rgb '#1f4e79'
unset multiplot
