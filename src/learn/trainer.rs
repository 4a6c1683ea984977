use std::num::NonZero;

use rayon::prelude::*;

use super::gradient::{Loss, Numbers, Part, gradient};
use crate::ParameterError;
use crate::parameter::{debug_as_sentence, require, require_not_negative, require_positive};
use crate::random::Stream;
use crate::vision::network::{Architecture, Network};

/// What a network is to learn from.
///
/// # For implementers
///
/// The same index and the same random numbers must give the same example, whichever thread asks.
pub trait Examples: Sync {
    /// Number of examples.
    fn count(&self) -> usize;

    /// Writes the input of an example, and returns the result that the network should have: a number, or for
    /// [`Loss::Classes`] the index of a class. Random numbers vary an input from one time to the next.
    fn write(&self, index: usize, random: &mut Stream, input: &mut [f32]) -> f32;
}

/// Options of a [`Trainer`].
#[derive(Debug, Clone, PartialEq)]
pub struct TrainerOptions {
    /// What to make small.
    pub loss: Loss,
    /// Number of examples between two steps.
    pub batch: usize,
    /// Part of the weights, times the rate, that each step takes off.
    pub decay: f64,
    /// Part of what the last layer sees that is hidden, at random for each example, so that it does not learn
    /// to rely on little (dropout, Srivastava et al. 2014).
    pub hidden: f64,
    /// Seed of the first weights, of the order of the examples, and of their variation.
    pub seed: u64,
    /// Number of threads, of which at most four are used. It does not change the result.
    pub threads: NonZero<usize>,
}

impl Default for TrainerOptions {
    /// Squares, 32 examples between two steps, a decay of 0.01, nothing hidden, seed 1, and one thread.
    fn default() -> Self {
        Self {
            loss: Loss::Squares,
            batch: 32,
            decay: 0.01,
            hidden: 0.0,
            seed: 1,
            threads: NonZero::<usize>::MIN,
        }
    }
}

/// Training that cannot go on.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum TrainingError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Weights or losses are no longer finite.
    #[error(
        "training: found a loss or a weight of {0}; expected a finite number: the rate is too high, or an example is none"
    )]
    Diverged(f64),
    /// Threads could not be started.
    #[error("training: threads: {0}")]
    Threads(String),
    /// A file that holds no state of a training.
    #[error("training: {0}")]
    File(String),
    /// The framework refused.
    #[error("training: {0}")]
    Framework(#[from] candle_core::Error),
}

debug_as_sentence!(TrainingError);

/// Trains a network; see the [module](super).
///
/// Steps are those of Adam with decoupled decay (Loshchilov and Hutter 2019). A batch has a fixed number of
/// parts, whose gradients are added in their order.
#[derive(Debug, Clone)]
pub struct Trainer {
    pub(super) architecture: Architecture,
    pub(super) options: TrainerOptions,
    pub(super) weights: Numbers,
    /// Means of gradients, and of their squares.
    pub(super) moments: [Numbers; 2],
    pub(super) steps: u64,
    pub(super) epochs: u64,
}

/// Number of parts of a batch.
const PARTS: usize = 4;
/// How much of the means of gradients and of squares a step keeps.
const KEPT: [f64; 2] = [0.9, 0.999];
/// Smallest root of a mean square by which a step is divided.
const LEAST: f64 = 1e-8;

impl Trainer {
    /// Creates a trainer with random weights (He et al. 2015).
    ///
    /// # Errors
    ///
    /// If an option is out of range, or the architecture has another number of results than its loss needs.
    pub fn new(architecture: Architecture, options: TrainerOptions) -> Result<Self, ParameterError> {
        let results = architecture.outputs();
        let fits = if options.loss == Loss::Squares { results == 1 } else { results > 1 };
        require("number of results", results as f64, fits, "1 for squares, more for classes")?;
        require("batch", options.batch as f64, (1..=10_000).contains(&options.batch), "1 to 10000")?;
        require_not_negative("decay", options.decay)?;
        require("hidden", options.hidden, (0.0..1.0).contains(&options.hidden), "0 to less than 1")?;
        let mut random = Stream::new(options.seed).child("weights", 0);
        let mut layer = |(filters, taps): (usize, usize)| {
            let spread = (2.0 / taps as f64).sqrt();
            let weights = (0..filters * taps).map(|_| (spread * random.normal()) as f32).collect();
            (weights, vec![0.0; filters])
        };
        let weights: Numbers = architecture.filters().flatten().map(&mut layer).collect();
        let moments = [zeros(&weights), zeros(&weights)];
        Ok(Self { architecture, options, weights, moments, steps: 0, epochs: 0 })
    }

    /// Number of epochs so far.
    pub fn epochs(&self) -> u64 {
        self.epochs
    }

    /// The network with the present weights.
    #[allow(clippy::missing_panics_doc, reason = "weights are checked after each epoch")]
    pub fn network(&self) -> Network {
        Network::new(self.architecture.clone(), self.weights.clone())
            .expect("weights were checked after each epoch")
    }

    /// Looks once at all examples, in random order. Steps are in proportion to the `rate`, 0.001 for example.
    /// Returns the mean loss.
    ///
    /// # Errors
    ///
    /// If there are no examples, the rate is out of range, or the loss is no longer finite. The trainer is
    /// then as before the epoch.
    pub fn epoch(&mut self, examples: &(impl Examples + ?Sized), rate: f64) -> Result<f64, TrainingError> {
        let count = examples.count();
        require("number of examples", count as f64, count > 0, "at least 1")?;
        require_positive("rate", rate)?;
        let before = self.clone();
        let sum = self.pass(examples, rate);
        if sum.is_err() {
            *self = before;
        }
        Ok(sum? / count as f64)
    }

    fn pass(&mut self, examples: &(impl Examples + ?Sized), rate: f64) -> Result<f64, TrainingError> {
        let stream = Stream::new(self.options.seed).child("epoch", self.epochs);
        // What candle does in parallel is done by the same threads.
        let threads = rayon::ThreadPoolBuilder::new().num_threads(self.options.threads.get().min(PARTS));
        let threads = threads.build().map_err(|error| TrainingError::Threads(error.to_string()))?;
        let mut order: Vec<usize> = (0..examples.count()).collect();
        stream.child("order", 0).shuffle(&mut order);
        let mut sum = 0.0;
        for batch in order.chunks(self.options.batch) {
            let (loss, gradient) = threads.install(|| self.batch(examples, batch, &stream))?;
            let mean = loss / batch.len() as f64;
            if !mean.is_finite() {
                return Err(TrainingError::Diverged(mean));
            }
            self.step(&gradient, 1.0 / batch.len() as f64, rate);
            sum += loss;
        }
        let [means, squares] = &self.moments;
        let state = [&self.weights, means, squares].into_iter().flat_map(numbers);
        if let Some(number) = state.copied().find(|number| !number.is_finite()) {
            return Err(TrainingError::Diverged(number.into()));
        }
        self.epochs = self.epochs.saturating_add(1);
        Ok(sum)
    }

    /// Sums of losses and gradients over a batch.
    fn batch(
        &self,
        examples: &(impl Examples + ?Sized),
        batch: &[usize],
        stream: &Stream,
    ) -> Result<(f64, Numbers), TrainingError> {
        let parts: Vec<&[usize]> = batch.chunks(batch.len().div_ceil(PARTS)).collect();
        let part = |part: &&[usize]| {
            let size = self.architecture.input().len();
            let mut inputs = vec![0.0; size * part.len()];
            let targets: Vec<f32> = inputs
                .chunks_exact_mut(size)
                .zip(*part)
                .map(|(input, &index)| {
                    examples.write(index, &mut stream.child("example", index as u64), input)
                })
                .collect();
            self.check(&targets)?;
            let shown = self.shown(part, stream);
            let examples = Part { inputs: &inputs, targets: &targets, shown: &shown };
            Ok(gradient(&self.architecture, &self.weights, &examples, self.options.loss)?)
        };
        let results: Vec<_> = parts.par_iter().map(part).collect::<Result<_, TrainingError>>()?;
        let mut sum = (0.0, zeros(&self.weights));
        for (loss, gradient) in results {
            sum.0 += loss;
            for (sum, gradient) in numbers_mut(&mut sum.1).zip(numbers(&gradient)) {
                *sum += gradient;
            }
        }
        Ok(sum)
    }

    /// Factors of what the last layer sees of examples: 0 for what is hidden, and for the rest what keeps the
    /// sum as it is. None if nothing is hidden.
    fn shown(&self, part: &[usize], stream: &Stream) -> Vec<f32> {
        let hidden = self.options.hidden;
        let width = self.architecture.sizes()[self.architecture.layers().len() - 1].len();
        let factors = |&index: &usize| {
            let mut random = stream.child("hidden", index as u64);
            let factor = move || if random.uniform() < hidden { 0.0 } else { (1.0 / (1.0 - hidden)) as f32 };
            std::iter::repeat_with(factor).take(width)
        };
        if hidden > 0.0 { part.iter().flat_map(factors).collect() } else { Vec::new() }
    }

    /// Fails for results that no network can have.
    fn check(&self, targets: &[f32]) -> Result<(), ParameterError> {
        let classes = self.architecture.outputs();
        for &target in targets {
            let (good, expected) = match self.options.loss {
                Loss::Squares => (target.is_finite(), "a finite number".to_owned()),
                Loss::Classes => (
                    target.fract() == 0.0 && target >= 0.0 && target < classes as f32,
                    format!("a class from 0 to {}", classes - 1),
                ),
            };
            require("result of an example", target.into(), good, expected)?;
        }
        Ok(())
    }

    /// Changes the weights by a gradient times a factor.
    fn step(&mut self, gradient: &Numbers, factor: f64, rate: f64) {
        self.steps = self.steps.saturating_add(1);
        let [first, second] = KEPT.map(|kept| 1.0 - power(kept, self.steps));
        let [means, squares] = &mut self.moments;
        let moments = numbers_mut(means).zip(numbers_mut(squares));
        for ((weight, (mean, square)), gradient) in
            numbers_mut(&mut self.weights).zip(moments).zip(numbers(gradient))
        {
            let gradient = factor * f64::from(*gradient);
            let towards = |mean: &mut f32, kept: f64, value: f64| {
                *mean = (kept * f64::from(*mean) + (1.0 - kept) * value) as f32;
                f64::from(*mean)
            };
            let mean = towards(mean, KEPT[0], gradient) / first;
            let square = towards(square, KEPT[1], gradient * gradient) / second;
            let change = mean / (square.sqrt() + LEAST) + self.options.decay * f64::from(*weight);
            *weight = (f64::from(*weight) - rate * change) as f32;
        }
    }
}

/// As many zeros.
fn zeros(like: &Numbers) -> Numbers {
    like.iter().map(|(weights, constants)| (vec![0.0; weights.len()], vec![0.0; constants.len()])).collect()
}

/// All numbers, layer by layer.
pub(super) fn numbers(all: &Numbers) -> impl Iterator<Item = &f32> {
    all.iter().flat_map(|(weights, constants)| weights.iter().chain(constants))
}

/// All numbers, layer by layer.
pub(super) fn numbers_mut(all: &mut Numbers) -> impl Iterator<Item = &mut f32> {
    all.iter_mut().flat_map(|(weights, constants)| weights.iter_mut().chain(constants))
}

/// A whole power, by squares.
fn power(mut base: f64, mut exponent: u64) -> f64 {
    let mut result = 1.0;
    while exponent > 0 {
        if exponent % 2 == 1 {
            result *= base;
        }
        exponent /= 2;
        base *= base;
    }
    result
}
