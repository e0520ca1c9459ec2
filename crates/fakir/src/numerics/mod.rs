//! Numerical building blocks: vectors, factorisations, [roots], quadrature, special functions, threads, and the convergence criteria.
//!
//! The module contains no contact mechanics and is not part of the public interface; its public items are for the other crates of the
//! project.

pub(crate) mod cholesky;
pub(crate) mod column_transform;
pub mod convergence;
pub(crate) mod cosine;
pub mod dense;
pub(crate) mod dual;
pub(crate) mod elimination;
pub(crate) mod elliptic;
pub(crate) mod fft;
pub(crate) mod line;
pub(crate) mod neighbours;
pub(crate) mod pivoting;
mod product;
pub(crate) mod quadrature;
pub mod roots;
pub(crate) mod row_pair;
pub(crate) mod simd;
pub(crate) mod special;
pub mod svd;
pub(crate) mod vector;
pub(crate) mod workers;
