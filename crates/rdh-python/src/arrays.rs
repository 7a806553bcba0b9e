//! NumPy's arrays in and out: the one place where dtypes, strides, byte orders and alignments are dealt with.
//!
//! What comes in may be anything that NumPy can make an array of. It is either converted without a loss that matters, or
//! refused with a `ValueError` that names the argument; data that is laid out as needed is not copied.

use numpy::{
    Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rdh_rows::Numbers;

/// Numbers that lie one after the other, in one of the two sizes that rays and vertices are wanted in.
pub(crate) enum Floats<'py> {
    /// As they are traced.
    F32(PyReadonlyArrayDyn<'py, f32>),
    /// Everything else becomes these first.
    F64(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> Floats<'py> {
    /// Reads an argument of real numbers.
    ///
    /// # Errors
    /// `ValueError` naming the argument: not an array, not of real numbers.
    pub(crate) fn read(argument: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = as_array(argument, value)?;
        if !matches!(array.dtype().kind(), b'b' | b'i' | b'u' | b'f') {
            return Err(refuse(argument, format_args!("real numbers are needed, not {}", array.dtype())));
        }
        if array.dtype().is_equiv_to(&f32::get_dtype(value.py())) {
            return plain::<f32>(argument, &array).map(Self::F32);
        }
        plain::<f64>(argument, &array).map(Self::F64)
    }

    /// How long the array is along each axis.
    pub(crate) fn shape(&self) -> &[usize] {
        match self {
            Self::F32(array) => array.shape(),
            Self::F64(array) => array.shape(),
        }
    }

    /// The numbers, in the order of C.
    pub(crate) fn numbers(&self) -> PyResult<Numbers<'_>> {
        Ok(match self {
            Self::F32(array) => Numbers::F32(array.as_slice()?),
            Self::F64(array) => Numbers::F64(array.as_slice()?),
        })
    }

    /// The same for an argument of rows: the shape without its last axis, which must be `columns` long.
    ///
    /// # Errors
    /// `ValueError` naming the argument, its shape and the one that is needed.
    pub(crate) fn leading_shape(&self, argument: &str, columns: &[usize]) -> PyResult<Vec<usize>> {
        match self.shape().split_last() {
            Some((last, leading)) if columns.contains(last) => Ok(leading.to_vec()),
            _ => {
                let wanted: Vec<_> = columns.iter().map(|n| format!("(..., {n})")).collect();
                let shape = PyTuple::new(self.py(), self.shape())?;
                Err(refuse(argument, format_args!("the shape must be {}, not {shape}", wanted.join(" or "))))
            }
        }
    }

    /// As [`Self::leading_shape`], for a plain list of rows: how many there are.
    pub(crate) fn row_count(&self, argument: &str, columns: usize) -> PyResult<usize> {
        match *self.shape() {
            [rows, last] if last == columns => Ok(rows),
            // An empty list has no columns to count.
            [0] => Ok(0),
            _ => {
                let shape = PyTuple::new(self.py(), self.shape())?;
                Err(refuse(argument, format_args!("the shape must be (n, {columns}), not {shape}")))
            }
        }
    }

    fn py(&self) -> Python<'py> {
        match self {
            Self::F32(array) => array.py(),
            Self::F64(array) => array.py(),
        }
    }
}

/// Reads an argument of rows of vertex indices, as n x 3 numbers that fit in 32 bits.
///
/// # Errors
/// `ValueError` naming the argument: not integers, another shape, or a negative or too large index and its row.
pub(crate) fn read_faces(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    let array = as_array(argument, value)?;
    let shape = array.shape().to_vec();
    if shape == [0] {
        return Ok(Vec::new());
    }
    if !matches!(shape[..], [_, 3]) {
        let shape = PyTuple::new(value.py(), shape)?;
        return Err(refuse(argument, format_args!("the shape must be (n, 3), not {shape}")));
    }
    match array.dtype().kind() {
        b'i' => rows_of_indices(argument, plain::<i64>(argument, &array)?.as_slice()?),
        b'u' => rows_of_indices(argument, plain::<u64>(argument, &array)?.as_slice()?),
        _ => Err(refuse(argument, format_args!("integers are needed, not {}", array.dtype()))),
    }
}

fn rows_of_indices<T: Copy + TryInto<u32> + std::fmt::Display>(argument: &str, all: &[T]) -> PyResult<Vec<[u32; 3]>> {
    let mut rows = reserve(argument, all.len() / 3)?;
    for (row, numbers) in all.as_chunks::<3>().0.iter().enumerate() {
        let mut indices = [0; 3];
        for (index, number) in indices.iter_mut().zip(numbers) {
            *index = (*number)
                .try_into()
                .map_err(|_| refuse(argument, format_args!("row {row}: {number} is not a vertex index")))?;
        }
        rows.push(indices);
    }
    Ok(rows)
}

/// Room for so many entries.
///
/// # Errors
/// `MemoryError` naming what it is for.
pub(crate) fn reserve<T>(what: &str, count: usize) -> PyResult<Vec<T>> {
    let mut all = Vec::new();
    all.try_reserve_exact(count)
        .map_err(|_| PyMemoryError::new_err(format!("{what}: {count} rows don't fit in memory")))?;
    Ok(all)
}

/// A new array of zeros.
///
/// # Errors
/// `MemoryError` if NumPy can't have the memory.
pub(crate) fn zeros<'py, T: Element>(py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let shape = PyTuple::new(py, shape)?;
    let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "zeros"), (shape, T::get_dtype(py)))?;
    Ok(array.cast_into()?)
}

/// The error of an argument.
pub(crate) fn refuse(argument: &str, reason: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("{argument}: {reason}"))
}

/// An array of what is given, by NumPy's own rules.
fn as_array<'py>(argument: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = value.py();
    let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (value,));
    Ok(array.map_err(|e| blame(argument, value, e))?.cast_into()?)
}

/// The array with its numbers one after the other, aligned and in this machine's byte order; copied only if it is not so.
fn plain<'py, T: Element>(argument: &str, array: &Bound<'py, PyUntypedArray>) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let py = array.py();
    let require = py.import(intern!(py, "numpy"))?.getattr(intern!(py, "require"))?;
    let plain = require.call1((array, T::get_dtype(py), ["C", "A"])).map_err(|e| blame(argument, array, e))?;
    let plain = plain.cast_into::<PyArrayDyn<T>>()?;
    plain.try_readonly().map_err(|e| refuse(argument, e))
}

/// Names the argument in whatever NumPy says; but running out of memory, and Ctrl-C, stay what they are.
fn blame(argument: &str, value: &Bound<'_, PyAny>, error: PyErr) -> PyErr {
    let py = value.py();
    if error.is_instance_of::<PyMemoryError>(py) || !error.is_instance_of::<pyo3::exceptions::PyException>(py) {
        return error;
    }
    let named = refuse(argument, error.value(py));
    named.set_cause(py, Some(error));
    named
}
