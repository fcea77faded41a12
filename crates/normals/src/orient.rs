//! Which way a normal points.

/// The normal, turned so that it points to the side of the plane through `point` on which the `sensor` is.
///
/// A sensor exactly in the plane decides nothing: the normal stays as it is.
///
/// ```
/// use terrace_normals::towards;
///
/// let floor = towards([0.0, 0.0, -1.0], [3.0, 2.0, 0.0], [0.0, 0.0, 1.5]);
/// assert_eq!(floor, [0.0, 0.0, 1.0]);
/// ```
pub fn towards(normal: [f64; 3], point: [f64; 3], sensor: [f64; 3]) -> [f64; 3] {
    let side: f64 = (0..3).map(|i| normal[i] * (sensor[i] - point[i])).sum();
    if side < 0.0 { normal.map(|x| -x) } else { normal }
}

/// The normal, turned so that its largest component is positive (the first of them on a tie): a fixed choice for when
/// no sensor position is known.
///
/// ```
/// use terrace_normals::canonical;
///
/// assert_eq!(canonical([0.6, 0.0, -0.8]), [-0.6, 0.0, 0.8]);
/// ```
pub fn canonical(normal: [f64; 3]) -> [f64; 3] {
    let mut largest = 0;
    for axis in 1..3 {
        if normal[axis].abs() > normal[largest].abs() {
            largest = axis;
        }
    }
    if normal[largest] < 0.0 { normal.map(|x| -x) } else { normal }
}

#[cfg(test)]
// Nothing is computed: components keep their bits or change their sign.
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_in_the_plane_or_nowhere_decides_nothing() {
        let n = [0.0, 0.6, -0.8];
        assert_eq!(towards(n, [1.0; 3], [5.0, 1.0, 1.0]), n);
        assert_eq!(towards(n, [1.0; 3], [f64::NAN; 3]), n);
    }

    #[test]
    fn either_sign_gives_one_canonical_normal() {
        for n in [[0.6, 0.0, -0.8], [0.5, -0.5, 0.1], [-0.5, 0.5, 0.1], [0.0, 0.0, -1.0]] {
            assert_eq!(canonical(n), canonical(n.map(|x| -x)));
        }
        assert_eq!(canonical([0.0; 3]), [0.0; 3]);
    }
}
