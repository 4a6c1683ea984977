use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use roverlab::evolve::{self, Evaluator, Evolution, Round};
use roverlab::io::{Error, ErrorKind, Result};

use crate::arrays::{self, Natural};
use crate::errors::{Failure, Outcome};

/// Evolution strategy with covariance matrix adaptation, for vectors of real numbers.
///
/// It needs the order of fitness only, and far fewer evaluations than a genetic algorithm where fitness is
/// smooth. Equal seeds and fitness give equal runs on every platform.
///
/// Parameters
/// ----------
/// mean : sequence of float
///     Where the search starts.
/// sigma : float
///     Step size: about a third of the way to where the best may be.
/// individuals : int, optional
///     Number of individuals of a generation, at least 4; otherwise 4 + 3 ln(genes).
/// seed : int
///     Seed of all random numbers.
///
/// Raises
/// ------
/// ValueError
///     If a parameter is out of range.
#[pyclass(frozen, module = "roverlab.evolve")]
#[derive(Debug)]
pub(crate) struct CmaEs {
    search: Mutex<evolve::CmaEs>,
}

/// Calls a function of Python with all individuals of a generation.
struct Called<'a, 'py> {
    fitness: &'a Bound<'py, PyAny>,
    /// What it raised.
    raised: Option<PyErr>,
}

impl Evaluator<Vec<f64>> for Called<'_, '_> {
    fn evaluate(&mut self, genomes: &[Vec<f64>], _round: Round) -> Result<Vec<f64>> {
        self.call(genomes).map_err(|failure| {
            self.raised = Some(failure.into());
            Error::new(ErrorKind::Other, "the function of fitness raised an exception")
        })
    }
}

impl Called<'_, '_> {
    fn call(&self, genomes: &[Vec<f64>]) -> Outcome<Vec<f64>> {
        let py = self.fitness.py();
        let shape = [genomes.len(), genomes[0].len()];
        let found = self.fitness.call1((arrays::matrix(py, genomes.concat(), shape)?,))?;
        let expected = format!("a sequence of {} numbers", genomes.len());
        if let Ok(array) = found.extract::<PyReadonlyArray1<'_, f64>>() {
            if array.len() != genomes.len() {
                return Err(arrays::wrong_shape("fitness", array.shape(), &arrays::shown(&[genomes.len()])));
            }
            return Ok(array.as_array().to_vec());
        }
        let numbers: Vec<f64> =
            found.extract().map_err(|_| Failure::kind("fitness", found.get_type(), &expected))?;
        if numbers.len() == genomes.len() {
            Ok(numbers)
        } else {
            Err(Failure::value("fitness", format!("{} numbers", numbers.len()), &expected))
        }
    }
}

impl CmaEs {
    fn lock(&self, py: Python<'_>) -> MutexGuard<'_, evolve::CmaEs> {
        self.search.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl CmaEs {
    #[new]
    #[pyo3(
        signature = (mean, sigma, individuals = None, seed = Natural::ONE),
        text_signature = "(mean, sigma, individuals=None, seed=1)"
    )]
    fn new(mean: Vec<f64>, sigma: f64, individuals: Option<Natural>, seed: Natural) -> Outcome<Self> {
        let individuals = match individuals {
            Some(individuals) => individuals.index("individuals")?,
            None => evolve::CmaEs::usual_individuals(mean.len()),
        };
        let search = evolve::CmaEs::new(mean, sigma, individuals, seed.named("seed")?)?;
        Ok(Self { search: Mutex::new(search) })
    }

    /// Draws a generation and evaluates it.
    ///
    /// Parameters
    /// ----------
    /// fitness : callable
    ///     Function from all individuals, an array of shape (individuals, genes), to their fitness: as many
    ///     finite numbers. Greater is fitter. It must not use this search.
    fn step(&self, py: Python<'_>, fitness: &Bound<'_, PyAny>) -> Outcome<()> {
        if !fitness.is_callable() {
            return Err(Failure::kind("fitness", fitness.get_type(), "a function of all individuals"));
        }
        // A generation that fails must leave the search as it was.
        let mut search = self.lock(py).clone();
        let mut called = Called { fitness, raised: None };
        let done = search.step(&mut called);
        if let Some(raised) = called.raised {
            return Err(raised.into());
        }
        done?;
        *self.lock(py) = search;
        Ok(())
    }

    /// The fittest individual so far and its fitness; None before the first generation.
    #[getter]
    fn best<'py>(&self, py: Python<'py>) -> Option<(Bound<'py, PyArray1<f64>>, f64)> {
        let search = self.lock(py);
        search.best().map(|best| (PyArray1::from_slice(py, &best.genome), best.fitness))
    }

    /// Mean of the distribution, which is often better than the fittest individual where fitness is noisy.
    #[getter]
    fn mean<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.lock(py).distribution().mean)
    }

    /// Step size.
    #[getter]
    fn sigma(&self, py: Python<'_>) -> f64 {
        self.lock(py).distribution().sigma
    }

    /// Best, mean and worst fitness of each generation: an array of shape (generations, 3).
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray2<f64>>> {
        let search = self.lock(py);
        let rows: Vec<f64> =
            search.history().iter().flat_map(|row| [row.best, row.mean, row.worst]).collect();
        let count = rows.len() / 3;
        arrays::matrix(py, rows, [count, 3])
    }
}
