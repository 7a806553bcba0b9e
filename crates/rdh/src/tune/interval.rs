//! How sure a ratio of two structures' costs is, from blocks of the same rays.
//!
//! A block's total over a hundred rays or more is near to normal whatever single rays cost, and blocks of different rays are
//! independent. So the paired differences of the blocks are judged by Student's t: at the small risks that are left when one
//! corrects for many candidates, a percentile bootstrap over a few dozen blocks would be too narrow, and it would need random
//! numbers. The interval of the ratio is Fieller's (1954): exactly the ratios that the test doesn't refuse.

/// Two structures' costs on the same blocks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paired {
    n: f64,
    mean: [f64; 2],
    /// Variances of both, and their covariance, of the means.
    variance: [f64; 2],
    covariance: f64,
}

/// With fewer blocks a t distribution has too wide tails to be of any use.
pub(super) const LEAST_BLOCKS: usize = 9;

impl Paired {
    /// Of `value` and `base`, block by block.
    pub(super) fn new(value: &[f64], base: &[f64]) -> Self {
        let n = value.len() as f64;
        let mean = [value, base].map(|x| x.iter().sum::<f64>() / n);
        let product = |a: &[f64], ma: f64, b: &[f64], mb: f64| {
            a.iter().zip(b).map(|(x, y)| (x - ma) * (y - mb)).sum::<f64>() / (n * (n - 1.0).max(1.0))
        };
        let variance = [product(value, mean[0], value, mean[0]), product(base, mean[1], base, mean[1])];
        Self { n, mean, variance, covariance: product(value, mean[0], base, mean[1]) }
    }

    /// `value / base`. Where the base is 0, one nanosecond is added to both, so that 0 / 0 is 1 and nothing is infinite.
    pub(super) fn ratio(&self) -> f64 {
        let [value, base] = self.mean;
        if base > 0.0 { value / base } else { (value + 1.0) / (base + 1.0) }
    }

    /// The chance to see a ratio this small if it were `limit`, or larger, in truth.
    pub(super) fn p_below(&self, limit: f64) -> f64 {
        let difference = self.mean[0] - limit * self.mean[1];
        let [a, b] = self.variance;
        let error = (a - 2.0 * limit * self.covariance + limit * limit * b).max(0.0).sqrt();
        match error {
            e if e > 0.0 => student_t(difference / e, self.freedom()),
            _ if difference < 0.0 => 0.0,
            _ => 1.0,
        }
    }

    /// The chance to see a ratio this large if it were `limit`, or smaller, in truth.
    pub(super) fn p_above(&self, limit: f64) -> f64 {
        if self.mean[0] == limit * self.mean[1] { 1.0 } else { 1.0 - self.p_below(limit) }
    }

    /// The ratios that neither end's test refuses at a risk of `risk` each; nothing if there is no bound.
    pub(super) fn interval(&self, risk: f64) -> Option<[f64; 2]> {
        let t = quantile(1.0 - risk, self.freedom());
        let ([x, y], [vx, vy]) = (self.mean, self.variance);
        let (a, b, c) = (y * y - t * t * vy, x * y - t * t * self.covariance, x * x - t * t * vx);
        let root = (b * b - a * c).max(0.0).sqrt();
        (a > 0.0).then(|| [(b - root) / a, (b + root) / a])
    }

    /// Even, for an odd number of blocks.
    fn freedom(&self) -> u32 {
        self.n as u32 - 1
    }
}

/// The part of a t distribution below `t`, for an even number of degrees of freedom: a finite sum (Abramowitz and Stegun
/// 26.7.4) that needs no function which platforms round differently.
fn student_t(t: f64, freedom: u32) -> f64 {
    debug_assert!(freedom >= 2 && freedom.is_multiple_of(2), "{freedom}");
    let nu = f64::from(freedom);
    let (sine, cosine2) = (t / (nu + t * t).sqrt(), nu / (nu + t * t));
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..freedom / 2 {
        term *= cosine2 * f64::from(2 * k - 1) / f64::from(2 * k);
        sum += term;
    }
    (0.5 + 0.5 * sine * sum).clamp(0.0, 1.0)
}

/// The `t` below which the part `p` lies, for `p` from 0.5 on.
fn quantile(p: f64, freedom: u32) -> f64 {
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if student_t(middle, freedom) < p { low = middle } else { high = middle }
    }
    high
}

/// Which hypotheses are refused at a risk of `risk` for all together: Holm's procedure (1979), which holds however they depend on
/// each other. `tried` is how many there were, those included that have no value here.
pub(super) fn holm(p: &[f64], tried: usize, risk: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut refused = vec![false; p.len()];
    for (rank, &i) in order.iter().enumerate() {
        if p[i] > risk / (tried - rank) as f64 {
            break;
        }
        refused[i] = true;
    }
    refused
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_t_is_that_of_the_tables() {
        for (freedom, p, t) in
            [(2, 0.975, 4.303), (8, 0.95, 1.860), (20, 0.975, 2.086), (30, 0.995, 2.750), (8, 0.999, 4.501)]
        {
            assert!((quantile(p, freedom) - t).abs() < 5e-4, "{freedom} {p}: {}", quantile(p, freedom));
            assert!((student_t(-t, freedom) - (1.0 - p)).abs() < 1e-4);
        }
        assert_eq!(student_t(0.0, 8), 0.5);
    }

    #[test]
    fn equal_costs_are_no_gain_and_smaller_ones_without_noise_are() {
        let base = [3.0, 4.0, 5.0, 3.5, 4.5, 4.0, 4.0, 3.0, 5.0];
        let same = Paired::new(&base, &base);
        assert_eq!((same.ratio(), same.p_below(1.0), same.p_above(1.0)), (1.0, 1.0, 1.0));
        let half = Paired::new(&base.map(|x| x / 2.0), &base);
        assert!(half.ratio() == 0.5 && half.p_below(0.9) < 1e-6 && half.p_above(1.0) > 0.99);
        let [low, high] = half.interval(0.001).unwrap();
        assert!((low - 0.5).abs() < 1e-9 && (high - 0.5).abs() < 1e-9);
        let nothing = Paired::new(&[0.0; 9], &[0.0; 9]);
        assert_eq!((nothing.ratio(), nothing.p_below(1.0), nothing.interval(0.05)), (1.0, 1.0, None));
        let from_nothing = Paired::new(&[3.0; 9], &[0.0; 9]);
        assert_eq!((from_nothing.ratio(), from_nothing.p_below(1.0), from_nothing.interval(0.05)), (4.0, 1.0, None));
    }

    #[test]
    fn the_interval_holds_exactly_what_the_test_lets_stand() {
        let value = [3.0, 4.2, 5.1, 3.3, 4.1, 4.4, 3.6, 2.8, 5.3];
        let base = [3.5, 4.0, 5.5, 3.5, 4.9, 4.0, 4.2, 3.1, 5.2];
        let paired = Paired::new(&value, &base);
        let [low, high] = paired.interval(0.01).unwrap();
        assert!(low < paired.ratio() && paired.ratio() < high);
        assert!((paired.p_below(high) - 0.01).abs() < 1e-6 && (paired.p_above(low) - 0.01).abs() < 1e-6);
    }

    #[test]
    fn holm_by_hand() {
        assert_eq!(holm(&[0.03, 0.004, 0.02], 4, 0.05), [false, true, false]);
        assert_eq!(holm(&[0.011, 0.016, 0.024, 0.04], 4, 0.05), [true, true, true, true]);
        assert_eq!(holm(&[0.001, 0.02], 9, 0.05), [true, false]);
        assert!(holm(&[], 3, 0.05).is_empty());
    }

    /// What is promised: of structures that are all as fast as the base in truth, whatever single rays cost, one is taken in at most
    /// 5 % of all races.
    #[test]
    fn candidates_that_are_no_better_are_rarely_taken() {
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        // Costs of rays have long tails: 10 to 300, and what two trees need for the same ray is alike.
        let mut block = || {
            let mut sums = [0.0; 7];
            for _ in 0..64 {
                let ray = 10.0 / (0.03 + uniform());
                sums.iter_mut().for_each(|sum| *sum += ray * (0.5 + uniform()));
            }
            sums
        };
        let (races, tried) = (600, 6);
        let taken = (0..races)
            .filter(|_| {
                let blocks: Vec<[f64; 7]> = (0..17).map(|_| block()).collect();
                let costs = |i: usize| blocks.iter().map(|b| b[i]).collect::<Vec<_>>();
                let p: Vec<f64> = (1..7).map(|i| Paired::new(&costs(i), &costs(0)).p_below(1.0)).collect();
                holm(&p, tried, 0.05).contains(&true)
            })
            .count();
        // 5 % of 600 are 30; four standard errors more are 51.
        assert!(taken <= 51, "{taken} of {races}");
        assert!(taken > 5, "{taken} of {races}: far too careful");
    }
}
