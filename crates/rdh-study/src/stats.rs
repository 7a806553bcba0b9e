//! Means, medians and intervals of ratios.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// Resamples of a bootstrap.
pub const RESAMPLES: usize = 2000;

/// The middle value, or the mean of the two middle ones; NaN for none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    quantile(&sorted, 0.5)
}

/// The geometric mean; NaN for none.
pub fn geometric_mean(ratios: &[f64]) -> f64 {
    (ratios.iter().map(|r| r.ln()).sum::<f64>() / ratios.len() as f64).exp()
}

/// `value / base`. Where one of them is 0, one is added to both, so that 0 / 0 is 1 and nothing is infinite: give totals
/// (tests of all rays, nanoseconds, bytes), of which one more or less means nothing.
pub fn ratio(value: f64, base: f64) -> f64 {
    if value > 0.0 && base > 0.0 { value / base } else { (value + 1.0) / (base + 1.0) }
}

/// A 95 % interval of the geometric mean of few paired ratios: Student's t of their logarithms. A single ratio is its own
/// interval, so that a loss that was seen only once still shows; none gives nothing.
pub fn paired_interval(ratios: &[f64]) -> Option<[f64; 2]> {
    let n = ratios.len();
    let mean = ratios.iter().map(|r| r.ln()).sum::<f64>() / n as f64;
    if n < 2 {
        return ratios.first().map(|&r| [r, r]);
    }
    let variance = ratios.iter().map(|r| (r.ln() - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
    let half = student_t_975(n - 1) * (variance / n as f64).sqrt();
    Some([(mean - half).exp(), (mean + half).exp()])
}

/// A 95 % interval of the geometric mean of all ratios: the percentile bootstrap, which draws whole clusters, because the
/// views of one scene are alike. The same seed gives the same interval. Nothing without ratios.
pub fn cluster_bootstrap(clusters: &[Vec<f64>], seed: u64) -> Option<[f64; 2]> {
    stratified_bootstrap(&[clusters.to_vec()], seed)
}

/// The geometric mean of the strata's geometric means; `[stratum][cluster][ratio]`. NaN for none.
pub fn stratified_mean(strata: &[Vec<Vec<f64>>]) -> f64 {
    let means: Vec<f64> = strata.iter().map(|clusters| geometric_mean(&clusters.concat())).collect();
    geometric_mean(&means)
}

/// As [`cluster_bootstrap`], of [`stratified_mean`]: clusters are drawn within their strata, which weigh alike.
pub fn stratified_bootstrap(strata: &[Vec<Vec<f64>>], seed: u64) -> Option<[f64; 2]> {
    let strata: Vec<Vec<Sum>> = strata.iter().map(|clusters| sums(clusters)).filter(|s| !s.is_empty()).collect();
    if strata.is_empty() {
        return None;
    }
    let mut random = Pcg32::new(seed, 0);
    let mut resample = || {
        let total: f64 = strata.iter().map(|sums| resampled_mean(sums, &mut random)).sum();
        total / strata.len() as f64
    };
    let mut means: Vec<f64> = (0..RESAMPLES).map(|_| resample()).collect();
    means.sort_unstable_by(f64::total_cmp);
    Some([quantile(&means, 0.025).exp(), quantile(&means, 0.975).exp()])
}

/// Of a cluster: the sum of the logarithms, and how many there are.
type Sum = (f64, usize);

fn sums(clusters: &[Vec<f64>]) -> Vec<Sum> {
    let filled = clusters.iter().filter(|c| !c.is_empty());
    filled.map(|c| (c.iter().map(|r| r.ln()).sum(), c.len())).collect()
}

fn resampled_mean(sums: &[Sum], random: &mut Pcg32) -> f64 {
    let draw = |_| {
        // The high bits of a product: uniform to within 2⁻³² times the number of clusters.
        sums[((u64::from(random.next_u32()) * sums.len() as u64) >> 32) as usize]
    };
    let (sum, count) = (0..sums.len()).map(draw).fold((0.0, 0), |(s, n), (ds, dn)| (s + ds, n + dn));
    sum / count as f64
}

/// The quantile of sorted values, linear between neighbours; NaN for none.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let at = p * last as f64;
    let (low, part) = (at.floor() as usize, at.fract());
    sorted[low] * (1.0 - part) + sorted[(low + 1).min(last)] * part
}

/// The 97.5 % quantile of Student's t; beyond 20 degrees of freedom that of 20, which is a little wide.
fn student_t_975(degrees: usize) -> f64 {
    const T: [f64; 20] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131,
        2.120, 2.110, 2.101, 2.093, 2.086,
    ];
    T[degrees.clamp(1, T.len()) - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn means_and_medians_by_hand() {
        assert!(near(geometric_mean(&[0.5, 2.0]), 1.0));
        assert!(near(geometric_mean(&[1.0, 1.0, 8.0]), 2.0));
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&[]).is_nan() && geometric_mean(&[]).is_nan());
    }

    #[test]
    fn ratios_are_defined_at_zero() {
        assert_eq!(ratio(3.0, 4.0), 0.75);
        assert_eq!(ratio(0.0, 0.0), 1.0);
        assert_eq!(ratio(0.0, 99.0), 0.01);
        assert_eq!(ratio(99.0, 0.0), 100.0);
    }

    #[test]
    fn a_paired_interval_by_hand() {
        // Logarithms ln 2 · (0, 1, 2): mean 1, deviation 1, so ± 4.303 / √3, in units of ln 2.
        let [low, high] = paired_interval(&[1.0, 2.0, 4.0]).unwrap();
        let half = 4.303 / 3f64.sqrt();
        assert!(near(low, 2f64.powf(1.0 - half)) && near(high, 2f64.powf(1.0 + half)));
        assert_eq!(paired_interval(&[1.3]), Some([1.3, 1.3]));
        assert_eq!(paired_interval(&[]), None);
    }

    #[test]
    fn a_bootstrap_draws_clusters_not_ratios() {
        // Two clusters: resamples are {a,a}, {a,b}, {b,b}, so the 95 % interval reaches from one mean to the other.
        let [low, high] = cluster_bootstrap(&[vec![0.5; 10], vec![2.0; 10]], 1).unwrap();
        assert!(near(low, 0.5) && near(high, 2.0));
        // Ratios that are drawn one by one would never get so far: with 20 of them the interval is much narrower.
        let singles: Vec<Vec<f64>> = [0.5, 2.0].iter().flat_map(|&r| std::iter::repeat_n(vec![r], 10)).collect();
        let [low, high] = cluster_bootstrap(&singles, 1).unwrap();
        assert!(low > 0.6 && high < 1.6 && low < 1.0 && high > 1.0, "{low} {high}");
        assert_eq!(cluster_bootstrap(&[], 1), None);
    }

    #[test]
    fn strata_weigh_alike_however_many_ratios_they_have() {
        let strata = [vec![vec![0.5; 30], vec![0.5; 10]], vec![vec![2.0]]];
        assert!(near(stratified_mean(&strata), 1.0));
        // Neither stratum varies, so that nothing does.
        let [low, high] = stratified_bootstrap(&strata, 1).unwrap();
        assert!(near(low, 1.0) && near(high, 1.0), "{low} {high}");
        assert_eq!(stratified_bootstrap(&[Vec::new(), vec![Vec::new()]], 1), None);
    }

    #[test]
    fn a_bootstrap_interval_covers_as_often_as_it_says() {
        // Means of 30 uniform logarithms: the interval must hold the truth (0) in about 95 % of 400 trials. The percentile
        // bootstrap is a little narrow at 30: its expected cover is 94 %; 4 standard errors are 4.7 points.
        let mut random = Pcg32::new(5, 5);
        let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        let trials = 400;
        let covers = (0..trials)
            .filter(|&seed| {
                let clusters: Vec<Vec<f64>> = (0..30).map(|_| vec![uniform().exp()]).collect();
                let [low, high] = cluster_bootstrap(&clusters, seed).unwrap();
                low <= 1.0 && 1.0 <= high
            })
            .count();
        let part = covers as f64 / trials as f64;
        assert!((0.89..=0.99).contains(&part), "{part}");
    }

    #[test]
    fn an_equal_seed_gives_an_equal_interval() {
        let clusters: Vec<Vec<f64>> = (1..9).map(|i| vec![f64::from(i) / 5.0, 1.0]).collect();
        assert_eq!(cluster_bootstrap(&clusters, 3), cluster_bootstrap(&clusters, 3));
        assert_ne!(cluster_bootstrap(&clusters, 3), cluster_bootstrap(&clusters, 4));
    }
}
