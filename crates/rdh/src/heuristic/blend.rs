//! Mixing ray counts with areas, "to avoid degeneracies" (Bittner and Havran 2009).

use super::Blend;

impl Blend {
    /// The part of the ray counts for `n` rays in the node; the areas have the rest. 0 without rays, always below 1.
    pub(super) fn weight(&self, n: f32) -> f32 {
        match *self {
            Self::Confidence { prior } if n > 0.0 => n / (n + prior),
            Self::Confidence { .. } => 0.0,
            Self::Paper { weight } => weight * (1.0 - 1.0 / (1.0 + 0.1 * n)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_rays_have_no_weight_and_many_have_nearly_all() {
        for blend in [Blend::Confidence { prior: 16.0 }, Blend::Paper { weight: 0.9 }, Blend::Confidence { prior: 0.0 }]
        {
            assert_eq!(blend.weight(0.0), 0.0);
            assert!(blend.weight(1e6) > 0.89);
        }
        assert_eq!(Blend::Confidence { prior: 16.0 }.weight(16.0), 0.5);
        assert!((Blend::Paper { weight: 0.9 }.weight(10.0) - 0.45).abs() < 1e-6);
        assert_eq!(Blend::Paper { weight: 0.0 }.weight(1e6), 0.0);
    }
}
