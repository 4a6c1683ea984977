use super::eigen::symmetric_eigen;
use super::evaluator::Evaluator;
use super::evolution::Evolution;
use super::population::Population;
use crate::geometry::math;
use crate::io::{Error, Result};
use crate::parameter::require_positive;
use crate::random::Stream;

/// The normal distribution adapted by [`CmaEs`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Distribution {
    /// Mean of the next individuals.
    pub mean: Vec<f64>,
    /// Step size: scale of the standard deviations.
    pub sigma: f64,
    /// Covariance matrix, row by row.
    pub covariance: Vec<f64>,
    /// Evolution path of the step size.
    sigma_path: Vec<f64>,
    /// Evolution path of the covariance.
    covariance_path: Vec<f64>,
}

/// Evolution strategy with covariance matrix adaptation, for real vectors (N. Hansen, "The CMA evolution
/// strategy: a tutorial", arXiv 1604.00772, with its default settings).
///
/// It learns useful directions and step sizes, so on smooth fitness it needs far fewer evaluations than a
/// genetic algorithm. Only the ranking of the fitness matters. A generation takes O(population · n²) plus an
/// eigendecomposition, O(n³), for n genes.
///
/// ```
/// use roverlab::evolve::{CmaEs, Evolution, Serial, StopRules, Trial};
/// // Rosenbrock's function: a curved valley with its optimum at (1, 1).
/// let valley = |x: &Vec<f64>, _: Trial| Ok(-(1.0 - x[0]).powi(2) - 100.0 * (x[1] - x[0] * x[0]).powi(2));
/// let mut search = CmaEs::new(vec![-1.0, 1.0], 0.5, 12, 1)?;
/// search.run(&mut Serial::new(valley), &StopRules::generations(150), |_| Ok(()))?;
/// let best = &search.best().expect("an individual").genome;
/// assert!((best[0] - 1.0).abs() < 1e-3 && (best[1] - 1.0).abs() < 1e-3);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CmaEs {
    population: Population<Vec<f64>>,
    distribution: Distribution,
    settings: Settings,
}

/// Constants of the tutorial, derived from the number of genes and of individuals.
#[derive(Debug, Clone)]
struct Settings {
    /// Weights of the fitter half; they sum to 1.
    weights: Vec<f64>,
    /// Variance-effective selection mass.
    effective: f64,
    sigma_rate: f64,
    sigma_damping: f64,
    path_rate: f64,
    rank_one: f64,
    rank_many: f64,
    /// Expected norm of a standard normal vector.
    expected_length: f64,
}

impl Settings {
    fn new(genes: usize, individuals: usize) -> Self {
        let n = genes as f64;
        let half = individuals / 2;
        let raw = |i: usize| math::ln(individuals as f64 / 2.0 + 0.5) - math::ln(i as f64 + 1.0);
        let total: f64 = (0..half).map(raw).sum();
        let weights: Vec<f64> = (0..half).map(|i| raw(i) / total).collect();
        let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let sigma_rate = (effective + 2.0) / (n + effective + 5.0);
        let path_rate = (4.0 + effective / n) / (n + 4.0 + 2.0 * effective / n);
        let rank_one = 2.0 / ((n + 1.3) * (n + 1.3) + effective);
        let many = 2.0 * (effective - 2.0 + 1.0 / effective) / ((n + 2.0) * (n + 2.0) + effective);
        Self {
            sigma_damping: 1.0 + 2.0 * (((effective - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + sigma_rate,
            rank_many: many.min(1.0 - rank_one),
            expected_length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
            weights,
            effective,
            sigma_rate,
            path_rate,
            rank_one,
        }
    }
}

/// Maximum number of genes: the covariance has a number for each pair.
const MOST_GENES: usize = 2000;
/// Maximum number of individuals per generation.
const MOST_INDIVIDUALS: usize = 10_000;

impl CmaEs {
    /// A search that starts at `mean` with step size `sigma` and `individuals` individuals per generation.
    ///
    /// # Errors
    ///
    /// If there are no genes or more than 2000, a number is not finite, `sigma` is not positive, or there are
    /// fewer than 4 individuals or more than 10,000.
    pub fn new(mean: Vec<f64>, sigma: f64, individuals: usize, seed: u64) -> Result<Self> {
        let n = mean.len();
        if !(1..=MOST_GENES).contains(&n) {
            return Err(Error::invalid_input("genes", n, &format!("1 to {MOST_GENES}")));
        }
        if !(4..=MOST_INDIVIDUALS).contains(&individuals) {
            return Err(Error::invalid_input(
                "individuals",
                individuals,
                &format!("4 to {MOST_INDIVIDUALS}"),
            ));
        }
        let mut covariance = vec![0.0; n * n];
        (0..n).for_each(|i| covariance[i * n + i] = 1.0);
        let distribution =
            Distribution { mean, sigma, covariance, sigma_path: vec![0.0; n], covariance_path: vec![0.0; n] };
        distribution.validate()?;
        let genomes = distribution.sample(individuals, &mut Stream::new(seed).child("breeding", 0));
        Self::resume(Population::new(genomes, seed)?, distribution)
    }

    /// Default number of individuals: 4 + 3 ln(genes).
    pub fn usual_individuals(genes: usize) -> usize {
        4 + (3.0 * math::ln(genes.max(1) as f64)) as usize
    }

    /// Resumes a run.
    ///
    /// # Errors
    ///
    /// If population and distribution are invalid or do not fit together.
    pub fn resume(population: Population<Vec<f64>>, distribution: Distribution) -> Result<Self> {
        population.validate()?;
        distribution.validate()?;
        let (genes, found) = (distribution.mean.len(), population.genomes[0].len());
        if found != genes {
            return Err(Error::invalid_input(
                "length of the genomes",
                found,
                &format!("{genes}, as the mean has"),
            ));
        }
        let settings = Settings::new(genes, population.genomes.len());
        Ok(Self { population, distribution, settings })
    }

    /// Distribution of the next individuals.
    pub fn distribution(&self) -> &Distribution {
        &self.distribution
    }

    /// Adapts the distribution to the present generation and draws the next one from it.
    fn breed(&mut self) {
        self.adapt();
        let population = &mut self.population;
        population.generation += 1;
        let mut random = Stream::new(population.seed).child("breeding", population.generation);
        population.genomes = self.distribution.sample(population.genomes.len(), &mut random);
        population.fitness.clear();
    }

    /// Equations 38 to 47 of the tutorial.
    fn adapt(&mut self) {
        let (settings, old) = (&self.settings, &self.distribution);
        let n = old.mean.len();
        let ranking = self.population.ranking();
        // Steps from the mean to the fitter half, in units of sigma.
        let steps: Vec<Vec<f64>> = ranking[..settings.weights.len()]
            .iter()
            .map(|&i| (0..n).map(|k| (self.population.genomes[i][k] - old.mean[k]) / old.sigma).collect())
            .collect();
        let weighted = |value: &dyn Fn(&[f64]) -> f64| -> f64 {
            settings.weights.iter().zip(&steps).map(|(weight, step)| weight * value(step)).sum()
        };
        let step: Vec<f64> = (0..n).map(|k| weighted(&|step| step[k])).collect();
        let whitened = old.whiten(&step);
        let gain = (settings.sigma_rate * (2.0 - settings.sigma_rate) * settings.effective).sqrt();
        let sigma_path = blend(&old.sigma_path, 1.0 - settings.sigma_rate, &whitened, gain);
        let length = norm(&sigma_path);
        let generations = (self.population.generation + 1) as f64;
        let warm_up = 1.0 - math::pow(1.0 - settings.sigma_rate, 2.0 * generations);
        // While the step size grows fast, the covariance path would only learn its length.
        let limit = (1.4 + 2.0 / (n as f64 + 1.0)) * settings.expected_length;
        let steady = f64::from(u8::from(length / warm_up.sqrt() < limit));
        let gain = steady * (settings.path_rate * (2.0 - settings.path_rate) * settings.effective).sqrt();
        let covariance_path = blend(&old.covariance_path, 1.0 - settings.path_rate, &step, gain);
        let missing = (1.0 - steady) * settings.path_rate * (2.0 - settings.path_rate);
        let kept = 1.0 + settings.rank_one * missing - settings.rank_one - settings.rank_many;
        let mut covariance = old.covariance.clone();
        for (k, value) in covariance.iter_mut().enumerate() {
            let (i, j) = (k / n, k % n);
            *value = kept * *value
                + settings.rank_one * covariance_path[i] * covariance_path[j]
                + settings.rank_many * weighted(&|step| step[i] * step[j]);
        }
        let growth = settings.sigma_rate / settings.sigma_damping * (length / settings.expected_length - 1.0);
        self.distribution = Distribution {
            mean: blend(&old.mean, 1.0, &step, old.sigma),
            // A growth by more than e per generation is never useful.
            sigma: old.sigma * math::exp(growth.min(1.0)),
            covariance,
            sigma_path,
            covariance_path,
        };
    }
}

impl Evolution<Vec<f64>> for CmaEs {
    fn population(&self) -> &Population<Vec<f64>> {
        &self.population
    }

    fn step(&mut self, evaluator: &mut dyn Evaluator<Vec<f64>>) -> Result<()> {
        if self.population.is_evaluated() {
            self.breed();
        }
        self.population.evaluate(evaluator)
    }
}

/// Minimum standard deviation along an axis, so that the distribution never degenerates.
const LEAST_ROOT: f64 = 1e-12;

impl Distribution {
    fn validate(&self) -> Result<()> {
        let n = self.mean.len();
        if n == 0 {
            return Err(Error::invalid_input("mean", "empty", "at least one gene"));
        }
        require_positive("sigma", self.sigma)?;
        let numbers =
            self.mean.iter().chain(&self.covariance).chain(&self.sigma_path).chain(&self.covariance_path);
        if let Some(found) = numbers.copied().find(|number| !number.is_finite()) {
            return Err(Error::invalid_input("a number of the distribution", found, "a finite number"));
        }
        let lengths = [self.covariance.len(), self.sigma_path.len(), self.covariance_path.len()];
        if lengths != [n * n, n, n] {
            let expected = format!("[{}, {n}, {n}] for {n} genes", n * n);
            return Err(Error::invalid_input(
                "sizes of covariance and paths",
                format!("{lengths:?}"),
                &expected,
            ));
        }
        Ok(())
    }

    /// Standard deviations along the principal axes, and the axes as columns.
    fn axes(&self) -> (Vec<f64>, Vec<f64>) {
        let (values, vectors) = symmetric_eigen(self.covariance.clone(), self.mean.len());
        (values.into_iter().map(|value| value.max(0.0).sqrt().max(LEAST_ROOT)).collect(), vectors)
    }

    fn sample(&self, count: usize, random: &mut Stream) -> Vec<Vec<f64>> {
        let n = self.mean.len();
        let (roots, vectors) = self.axes();
        let mut draw = || {
            let along: Vec<f64> = roots.iter().map(|root| self.sigma * root * random.normal()).collect();
            let coordinate = |i: usize| (0..n).map(|k| vectors[i * n + k] * along[k]).sum::<f64>();
            (0..n).map(|i| self.mean[i] + coordinate(i)).collect()
        };
        (0..count).map(|_| draw()).collect()
    }

    /// Transforms a step to coordinates in which the distribution is isotropic.
    fn whiten(&self, step: &[f64]) -> Vec<f64> {
        let n = step.len();
        let (roots, vectors) = self.axes();
        let along = |k: usize| (0..n).map(|i| vectors[i * n + k] * step[i]).sum::<f64>() / roots[k];
        let along: Vec<f64> = (0..n).map(along).collect();
        (0..n).map(|i| (0..n).map(|k| vectors[i * n + k] * along[k]).sum()).collect()
    }
}

fn blend(a: &[f64], of_a: f64, b: &[f64], of_b: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| of_a * a + of_b * b).collect()
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::{Serial, StopReason, StopRules, Trial};
    use super::*;

    /// Generations until the fitness is within 1e-8 of its maximum, 0.
    fn generations(fitness: impl Fn(&[f64]) -> f64, start: Vec<f64>, individuals: usize) -> u64 {
        let mut search = CmaEs::new(start, 0.5, individuals, 1).unwrap();
        let rules = StopRules { goal: Some(-1e-8), ..StopRules::generations(4000) };
        let mut evaluator = Serial::new(|x: &Vec<f64>, _: Trial| Ok(fitness(x)));
        let reason = search.run(&mut evaluator, &rules, |_| Ok(())).unwrap();
        assert_eq!(reason, StopReason::Goal, "{:?}", search.best());
        search.population().generation
    }

    /// The tutorial states about 2,000 evaluations for a sphere with ten genes and 6,000 for an ellipsoid.
    #[test]
    fn bowls_are_descended_as_fast_as_published() {
        let bowl = |x: &[f64]| -x.iter().map(|x| x * x).sum::<f64>();
        let evaluations = 10 * generations(bowl, vec![1.0; 10], 10);
        assert!((1_000..3_000).contains(&evaluations), "{evaluations}");
        let stretched = |x: &[f64]| {
            -x.iter().enumerate().map(|(i, x)| math::pow(1e6, i as f64 / 9.0) * x * x).sum::<f64>()
        };
        let evaluations = 10 * generations(stretched, vec![1.0; 10], 10);
        assert!((3_500..10_000).contains(&evaluations), "{evaluations}");
    }

    #[test]
    fn a_curved_valley_is_followed() {
        let rosenbrock = |x: &[f64]| {
            -x.windows(2)
                .map(|w| {
                    let (a, b) = (w[1] - w[0] * w[0], 1.0 - w[0]);
                    100.0 * a * a + b * b
                })
                .sum::<f64>()
        };
        generations(rosenbrock, vec![0.0; 5], 8);
    }

    #[test]
    fn only_the_order_of_fitness_counts() {
        let run = |fitness: fn(f64) -> f64| {
            let mut search = CmaEs::new(vec![2.0, -1.0], 0.5, 6, 4).unwrap();
            let bowl = |x: &Vec<f64>, _: Trial| Ok(fitness(-x[0] * x[0] - 3.0 * x[1] * x[1]));
            search.run(&mut Serial::new(bowl), &StopRules::generations(30), |_| Ok(())).unwrap();
            search.distribution().clone()
        };
        assert_eq!(run(|f| f), run(|f| 5.0 * f - 70.0));
    }

    #[test]
    fn a_resumed_search_is_the_search() {
        let bowl = |x: &Vec<f64>, _: Trial| Ok(-x[0] * x[0] - 9.0 * x[1] * x[1]);
        let run = |search: &mut CmaEs, generations| {
            search.run(&mut Serial::new(bowl), &StopRules::generations(generations), |_| Ok(())).unwrap();
        };
        let mut whole = CmaEs::new(vec![1.0, 1.0], 0.3, 6, 9).unwrap();
        run(&mut whole, 20);
        let mut part = CmaEs::new(vec![1.0, 1.0], 0.3, 6, 9).unwrap();
        run(&mut part, 7);
        let mut resumed = CmaEs::resume(part.population().clone(), part.distribution().clone()).unwrap();
        run(&mut resumed, 20);
        assert_eq!(
            (resumed.population(), resumed.distribution()),
            (whole.population(), whole.distribution())
        );
    }

    #[test]
    fn flat_fitness_neither_fails_nor_ends() {
        let mut search = CmaEs::new(vec![1.0; 3], 0.5, 6, 1).unwrap();
        let mut flat = Serial::new(|_: &Vec<f64>, _: Trial| Ok(0.0));
        search.run(&mut flat, &StopRules::generations(300), |_| Ok(())).unwrap();
        assert!(search.distribution().sigma.is_finite());
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let text = |mean: &[f64], sigma, individuals| {
            CmaEs::new(mean.to_vec(), sigma, individuals, 1).unwrap_err().to_string()
        };
        assert_eq!(text(&[], 1.0, 8), "genes is 0; expected 1 to 2000");
        assert_eq!(text(&vec![0.0; 100_000], 1.0, 8), "genes is 100000; expected 1 to 2000", "80 GB");
        assert_eq!(text(&[1.0], 0.0, 8), "sigma is 0; expected a positive, finite number");
        assert_eq!(text(&[1.0], 1.0, 3), "individuals is 3; expected 4 to 10000");
        let nan = text(&[f64::NAN], 1.0, 8);
        assert_eq!(nan, "a number of the distribution is NaN; expected a finite number");
    }
}
