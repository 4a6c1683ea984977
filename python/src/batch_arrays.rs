//! The arrays of a batch.

use numpy::ndarray::Dimension;
use numpy::{
    Element, PyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyReadwriteArray,
    PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;

use crate::arrays::state;
use crate::errors::{Failure, Outcome};
use crate::worlds::{Rows, Shape};

/// What is known of all robots, a row for each.
#[derive(Debug)]
pub(crate) struct Arrays {
    pub(crate) ranges: Py<PyArray2<f64>>,
    pub(crate) distances: Py<PyArray2<f64>>,
    pub(crate) poses: Py<PyArray2<f64>>,
    pub(crate) speeds: Py<PyArray2<f64>>,
    pub(crate) stalled: Py<PyArray1<bool>>,
    pub(crate) true_poses: Py<PyArray2<f64>>,
    pub(crate) contacts: Py<PyArray1<u32>>,
    pub(crate) walls: Py<PyArray2<f64>>,
    pub(crate) lanes: Py<PyArray2<f64>>,
    pub(crate) space: Py<PyArray2<f64>>,
}

impl Arrays {
    pub(crate) fn new(py: Python<'_>, shape: Shape) -> Self {
        let matrix = |columns| PyArray2::zeros(py, [shape.robots, columns], false).unbind();
        Self {
            ranges: matrix(shape.beams),
            distances: matrix(shape.sensors),
            poses: matrix(3),
            speeds: matrix(2),
            stalled: PyArray1::zeros(py, shape.robots, false).unbind(),
            true_poses: matrix(3),
            contacts: PyArray1::zeros(py, shape.robots, false).unbind(),
            walls: matrix(shape.walls),
            lanes: matrix(shape.lane),
            space: matrix(shape.space),
        }
    }

    /// Calls a function with all rows, which nothing else of the package uses meanwhile.
    pub(crate) fn with_rows<T>(
        &self,
        py: Python<'_>,
        shape: Shape,
        work: impl FnOnce(Rows<'_>) -> Outcome<T>,
    ) -> Outcome<T> {
        macro_rules! borrowed {
            ($($array:ident),+) => {$(
                let mut $array = self.$array.bind(py).try_readwrite().map_err(|error| {
                    Failure::value(stringify!($array), state(&error), "an array that nothing else uses")
                })?;
            )+};
        }
        borrowed!(ranges, distances, poses, speeds, stalled, true_poses, contacts, walls, lanes, space);
        work(Rows {
            ranges: whole("ranges", &mut ranges, shape.robots * shape.beams)?,
            distances: whole("distances", &mut distances, shape.robots * shape.sensors)?,
            poses: whole("poses", &mut poses, shape.robots * 3)?,
            speeds: whole("speeds", &mut speeds, shape.robots * 2)?,
            stalled: whole("stalled", &mut stalled, shape.robots)?,
            true_poses: whole("true_poses", &mut true_poses, shape.robots * 3)?,
            contacts: whole("contacts", &mut contacts, shape.robots)?,
            walls: whole("walls", &mut walls, shape.robots * shape.walls)?,
            lanes: whole("lanes", &mut lanes, shape.robots * shape.lane)?,
            space: whole("space", &mut space, shape.robots * shape.space)?,
        })
    }
}

/// The numbers of an array, unless who has found it as the base of a view has resized it or changed its type.
fn whole<'a, T: Element, D: Dimension>(
    name: &str,
    array: &'a mut PyReadwriteArray<'_, T, D>,
    length: usize,
) -> Outcome<&'a mut [T]> {
    let altered = || Failure::value(name, "altered", "the batch's own array");
    if array.len() != length || array.dtype().itemsize() != size_of::<T>() {
        return Err(altered());
    }
    array.as_slice_mut().map_err(|_| altered())
}

/// A view of an array: who resizes it or gives it another type leaves the array itself as it is.
pub(crate) fn view<'py, T: Element, D: Dimension>(
    py: Python<'py>,
    array: &Py<PyArray<T, D>>,
) -> PyResult<Bound<'py, PyAny>> {
    array.bind(py).call_method0(intern!(py, "view"))
}
