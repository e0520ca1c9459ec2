//! One product with the operators of the half-space on square grids.

use divan::Bencher;
use fakir::halfspace::elements::{FreeSpaceConvolution, Operator, PeriodicConvolution};
use fakir::problem::{Cells, Grid};

fn main() {
    divan::main();
}

const SIDES: [usize; 4] = [256, 512, 1024, 2048];

fn cells(side: usize) -> Cells {
    let grid = Grid::centred(side, side, 1e-6).expect("a valid grid");
    Cells::all(&grid)
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads can be started")
}

fn product(bencher: Bencher<'_, '_>, operator: &mut impl Operator) {
    let pressure: Vec<f64> = (0..operator.len()).map(|k| (k as f64).sin()).collect();
    let mut displacement = vec![0.0; pressure.len()];
    bencher.bench_local(|| operator.apply(&pressure, &mut displacement));
}

#[divan::bench(args = SIDES)]
fn free_space_one_thread(bencher: Bencher<'_, '_>, side: usize) {
    product(
        bencher,
        &mut FreeSpaceConvolution::new(cells(side), 1e-6, None),
    );
}

#[divan::bench(args = SIDES)]
fn free_space_two_threads(bencher: Bencher<'_, '_>, side: usize) {
    let pool = pool(2);
    product(
        bencher,
        &mut FreeSpaceConvolution::new(cells(side), 1e-6, Some(&pool)),
    );
}

/// Discs of 16 cells diameter at a pitch of 80 cells: a surface fraction of 3 %.
#[divan::bench(args = SIDES)]
fn pattern_one_thread(bencher: Bencher<'_, '_>, side: usize) {
    let grid = Grid::centred(side, side, 1e-6).expect("a valid grid");
    let offset = |x: f64| x - 80e-6 * (x / 80e-6).round();
    let cells = Cells::where_centre(&grid, |[x, y]| offset(x).hypot(offset(y)) < 8e-6);
    product(bencher, &mut FreeSpaceConvolution::new(cells, 1e-6, None));
}

#[divan::bench(args = SIDES)]
fn periodic_one_thread(bencher: Bencher<'_, '_>, side: usize) {
    product(
        bencher,
        &mut PeriodicConvolution::new(cells(side), 1e-6, None),
    );
}

#[divan::bench(args = [256, 512, 1024])]
fn free_space_setup(bencher: Bencher<'_, '_>, side: usize) {
    let cells = cells(side);
    bencher.bench_local(|| FreeSpaceConvolution::new(cells.clone(), 1e-6, None));
}
