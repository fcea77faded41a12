//! What the paper leaves open.

/// Printed at the end of every reproduction.
pub const TEXT: &str = "
What the paper does not say, and what was assumed
  - the size of the synthetic planes, their number of points and the noise: a board of 1.2 x 0.8 m on two panels,
    70 000 points, white noise of 8 mm ('terrace synth desk')
  - cell size, density threshold, depth, connectivity: 3 cm (6 cm on the sequence), a tenth of the median density
    (20 on the sequence), depth 1, 26 neighbours
  - the threshold omega of the normals' uncertainty: 0.4 (0.2 on the sequence)
  - whether phi is a cosine or an angle: D = 1/2 E|n - n_C|^2, which is 1 - cos without errors, so that 0 <= phi <= 1
  - the initial phi of the real experiment: 0.3
  - the weights of the cost: w_nv = 1, w_nc = 0.01
  - whether the sum in the cost weighs clusters by their size: both forms are printed
  - population, subset and rounds of the random search: 20, 2, 60; samples outside 0..1 are drawn again
  - which clusters are uncertain: those with a component of s above 0.15
  - over which clusters the tables average: more than 5 cells (Table I), at least 5 cells (Table II)
  - Table II's figures and the scans behind it are not in the text: any posed Kinect sequence stands in
Every difference from the paper is listed in docs/deviations.md.
";
