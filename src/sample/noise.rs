//! Smooth noise in space, from a seed: what makes a break ragged.

/// A 64-bit mix of two words (the finaliser of splitmix64).
pub(super) fn mix(seed: u64, word: u64) -> u64 {
    let mut z = seed ^ word.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A number in 0..1 from a seed and a counter.
pub(super) fn uniform(seed: u64, word: u64) -> f64 {
    (mix(seed, word) >> 11) as f64 / (1u64 << 53) as f64
}

/// Value noise on the unit lattice, -1 to 1.
fn value(seed: u64, p: [f64; 3]) -> f64 {
    let cell = p.map(f64::floor);
    let t: [f64; 3] = std::array::from_fn(|k| {
        let x = p[k] - cell[k];
        x * x * (3.0 - 2.0 * x)
    });
    let mut sum = 0.0;
    for corner in 0..8u64 {
        let bit: [f64; 3] = std::array::from_fn(|k| ((corner >> k) & 1) as f64);
        let weight: f64 = (0..3).map(|k| if bit[k] > 0.5 { t[k] } else { 1.0 - t[k] }).product();
        let key = (0..3).fold(seed, |key, k| mix(key, (cell[k] + bit[k]) as i64 as u64));
        sum += weight * (uniform(key, 1) * 2.0 - 1.0);
    }
    sum
}

/// Three octaves, each half as strong and twice as fine, within -1.75 to 1.75.
pub(super) fn fractal(seed: u64, p: [f64; 3]) -> f64 {
    (0..3)
        .map(|octave| {
            let scale = (1u64 << octave) as f64;
            value(mix(seed, octave), p.map(|x| x * scale)) / scale
        })
        .sum()
}
