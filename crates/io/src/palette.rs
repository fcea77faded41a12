//! One colour for each plane.

use terrace_types::PlaneId;

/// The colour of points of no plane: grey.
pub const UNLABELLED: [u8; 3] = [128, 128, 128];

/// The colour of a plane as red, green, blue.
///
/// Hues go round the circle by the golden ratio, so that planes of neighbouring numbers look different; saturation and
/// brightness change in step with them. The same plane number always has the same colour, and none is grey.
///
/// ```
/// use terrace_io::palette;
/// use terrace_types::PlaneId;
///
/// let colours: Vec<_> = (0..3).filter_map(PlaneId::from_index).map(palette::colour).collect();
/// assert_eq!(colours, [[242, 97, 168], [54, 182, 217], [242, 231, 97]]);
/// ```
pub fn colour(plane: PlaneId) -> [u8; 3] {
    const GOLDEN_RATIO_CONJUGATE: f64 = 0.618_033_988_749_894_9;
    let hue = (f64::from(plane.get()) * GOLDEN_RATIO_CONJUGATE + 0.3).fract();
    let (saturation, value) = match plane.get() % 4 {
        0 => (0.85, 0.75),
        2 => (0.75, 0.85),
        _ => (0.60, 0.95),
    };
    hsv(hue, saturation, value)
}

/// The colour of a label: that of its plane, or [`UNLABELLED`].
pub fn colour_of(label: Option<PlaneId>) -> [u8; 3] {
    label.map_or(UNLABELLED, colour)
}

/// Hue, saturation and value from 0 to 1 to red, green, blue.
fn hsv(hue: f64, saturation: f64, value: f64) -> [u8; 3] {
    // Distance of each primary from the hue on the circle of six sectors; 0 at full strength.
    [0.0, 2.0, 4.0].map(|primary| {
        let around = (hue * 6.0 - primary).rem_euclid(6.0);
        let strength = ((around - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        let channel = value * (1.0 - saturation * (1.0 - strength)) * 255.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
        let byte = channel.round() as u8;
        byte
    })
}
