/// Eigenvalues of a symmetric matrix and its normalised eigenvectors (as columns), by cyclic Jacobi rotations
/// (G. Golub and C. Van Loan, "Matrix Computations", section 8.5).
///
/// Matrices are stored row by row. The pairs are in the order of the diagonal. The same input gives the same
/// bits on every processor, unlike libraries that select their code at run time.
pub(super) fn symmetric_eigen(mut matrix: Vec<f64>, n: usize) -> (Vec<f64>, Vec<f64>) {
    /// Maximum number of sweeps; convergence is quadratic, and six are typical.
    const SWEEPS: usize = 30;
    let mut vectors = vec![0.0; n * n];
    for i in 0..n {
        vectors[i * n + i] = 1.0;
    }
    for _ in 0..SWEEPS {
        if off_diagonal(&matrix, n) == 0.0 {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                rotate(&mut matrix, &mut vectors, n, p, q);
            }
        }
    }
    ((0..n).map(|i| matrix[i * n + i]).collect(), vectors)
}

/// Sum of squares above the diagonal.
fn off_diagonal(matrix: &[f64], n: usize) -> f64 {
    (0..n).flat_map(|i| (i + 1..n).map(move |j| i * n + j)).map(|k| matrix[k] * matrix[k]).sum()
}

/// Rotates the element at row `p`, column `q` to zero.
fn rotate(matrix: &mut [f64], vectors: &mut [f64], n: usize, p: usize, q: usize) {
    let corner = matrix[p * n + q];
    if corner == 0.0 {
        return;
    }
    let half = (matrix[q * n + q] - matrix[p * n + p]) / (2.0 * corner);
    let tangent = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
    let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
    let sine = tangent * cosine;
    let mix = |matrix: &mut [f64], a: usize, b: usize| {
        let (x, y) = (matrix[a], matrix[b]);
        matrix[a] = cosine * x - sine * y;
        matrix[b] = sine * x + cosine * y;
    };
    for k in 0..n {
        mix(matrix, k * n + p, k * n + q);
    }
    for k in 0..n {
        mix(matrix, p * n + k, q * n + k);
    }
    for k in 0..n {
        mix(vectors, k * n + p, k * n + q);
    }
    matrix[p * n + q] = 0.0;
    matrix[q * n + p] = 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn vectors_and_values_make_the_matrix_again(
            n in 1..7_usize,
            numbers in prop::collection::vec(-5.0..5.0f64, 49),
        ) {
            let matrix: Vec<f64> = (0..n * n).map(|k| numbers[k] + numbers[(k % n) * n + k / n]).collect();
            let (values, vectors) = symmetric_eigen(matrix.clone(), n);
            for i in 0..n {
                for j in 0..n {
                    let again: f64 = (0..n).map(|k| vectors[i * n + k] * values[k] * vectors[j * n + k]).sum();
                    prop_assert!((again - matrix[i * n + j]).abs() < 1e-9);
                    let product: f64 = (0..n).map(|k| vectors[k * n + i] * vectors[k * n + j]).sum();
                    let identity = f64::from(u8::from(i == j));
                    prop_assert!((product - identity).abs() < 1e-9);
                }
            }
        }
    }
}
