//! Measures the time of one product or one solution on a grid: fakir's part of `bench/elements.py`.
//!
//! ```text
//! peer product side=512 threads=1 repeats=20
//! peer solve separation=FILE columns=512 rows=512 cell=1e-3 boundary=free|periodic
//!      force=1.0|indentation=1e-3 tolerance=1e-8 threads=1 [reach=1e-3]
//! ```
//!
//! The file contains the separation of the undeformed surfaces at every cell as little-endian doubles, by rows along x. Cells whose
//! separation exceeds `reach` are omitted, since they cannot be in contact. The compliance is 1. `cells` is the number of cells in the
//! final solution. Prints one JSON object; memory is the increase of the memory of the process after the creation of the operator.

use fakir::halfspace::elements::{FreeSpaceConvolution, Operator};
use fakir::problem::{Boundary, Cells, Grid};
use fakir::solve::elements::separation::{ActiveContact, Separation};
use fakir::solve::elements::solver::{Prescribed, Settings};
use fakir::state::Run;
use rayon::ThreadPool;
use std::collections::HashMap;
use std::error::Error;
use std::str::FromStr;
use std::time::Instant;

type Answer<T> = Result<T, Box<dyn Error>>;

struct Arguments(HashMap<String, String>);

impl Arguments {
    fn text(&self, key: &str) -> Answer<&str> {
        let text = self.0.get(key).map(String::as_str);
        text.ok_or_else(|| format!("{key}=... is missing").into())
    }

    fn value<T: FromStr<Err: Error + 'static>>(&self, key: &str) -> Answer<T> {
        Ok(self.text(key)?.parse()?)
    }

    fn pool(&self) -> Answer<Option<ThreadPool>> {
        let threads = self.value("threads")?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        Ok((threads > 1).then(|| pool.build()).transpose()?)
    }
}

fn main() -> Answer<()> {
    let mut words = std::env::args().skip(1);
    let task = words.next().unwrap_or_default();
    let pairs = words.map(|word| {
        let (key, value) = word
            .split_once('=')
            .ok_or(format!("{word}: no key=value"))?;
        Ok::<_, String>((key.to_string(), value.to_string()))
    });
    let arguments = Arguments(pairs.collect::<Result<_, _>>()?);
    match task.as_str() {
        "product" => product(&arguments),
        "solve" => solve(&arguments),
        _ => Err("the first argument must be product or solve".into()),
    }
}

/// The median time of a product with the operator of the non-periodic half-space.
fn product(arguments: &Arguments) -> Answer<()> {
    let side = arguments.value("side")?;
    let repeats: usize = arguments.value("repeats")?;
    let pool = arguments.pool()?;
    let grid = Grid::centred(side, side, 1.0)?;
    let pressure: Vec<f64> = (0..grid.cell_count()).map(|k| (k as f64).sin()).collect();
    let mut displacement = vec![0.0; pressure.len()];
    let baseline = resident()?;
    let start = Instant::now();
    let mut operator = FreeSpaceConvolution::new(Cells::all(&grid), 1.0, pool.as_ref());
    let setup = start.elapsed().as_secs_f64();
    operator.apply(&pressure, &mut displacement);
    let mut times: Vec<f64> = (0..repeats)
        .map(|_| {
            let start = Instant::now();
            operator.apply(&pressure, &mut displacement);
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_unstable_by(f64::total_cmp);
    println!(
        r#"{{"setup_s": {setup:e}, "product_s": {:e}, "memory_bytes": {}, "check": {:e}}}"#,
        times[times.len() / 2],
        peak()?.saturating_sub(baseline),
        displacement[grid.cell_count() / 2],
    );
    Ok(())
}

fn solve(arguments: &Arguments) -> Answer<()> {
    let (columns, rows) = (arguments.value("columns")?, arguments.value("rows")?);
    let grid = Grid::centred(columns, rows, arguments.value("cell")?)?;
    let load = match arguments.value("force") {
        Ok(force) => Prescribed::Force(force),
        Err(_) => Prescribed::Indentation(arguments.value("indentation")?),
    };
    let settings = Settings {
        tolerance: arguments.value("tolerance")?,
        ..Settings::default()
    };
    let pool = arguments.pool()?;
    let mut field: Vec<f64> = std::fs::read(arguments.text("separation")?)?
        .as_chunks()
        .0
        .iter()
        .map(|bytes| f64::from_le_bytes(*bytes))
        .collect();
    let reach = arguments.value("reach").unwrap_or(f64::INFINITY);
    let baseline = resident()?;

    let (start, processor) = (Instant::now(), processor_seconds()?);
    for separation in field.iter_mut().filter(|separation| **separation > reach) {
        *separation = f64::INFINITY;
    }
    let separation = Separation {
        grid,
        values: &field,
        boundary: match arguments.text("boundary")? {
            "free" => Boundary::FreeSpace,
            "periodic" => Boundary::Periodic,
            other => {
                return Err(format!("invalid boundary={other}: must be free or periodic").into());
            }
        },
        compliance: 1.0,
    };
    let run = Run {
        pool: pool.as_ref(),
        ..Run::default()
    };
    let ActiveContact { cells, contact } = separation.press(load, &settings, &run)?;
    let total = start.elapsed().as_secs_f64();
    let processor = processor_seconds()? - processor;
    let loaded = contact.pressure.iter().filter(|p| **p > 0.0).count();
    println!(
        r#"{{"total_s": {total:e}, "processor_s": {processor:e}, "memory_bytes": {}, "iterations": {}, "products": {}, "force": {:.15e}, "indentation": {:.15e}, "bound": {:e}, "cells": {}, "loaded": {loaded}, "ended": "{}"}}"#,
        peak()?.saturating_sub(baseline),
        contact.products,
        contact.products,
        contact.force,
        contact.indentation,
        contact.certificate.energy_bound,
        cells.len(),
        contact.termination.description(),
    );
    Ok(())
}

/// Processor time of all threads of the process in seconds, from Linux.
fn processor_seconds() -> Answer<f64> {
    let mut nanoseconds = 0;
    for thread in std::fs::read_dir("/proc/self/task")? {
        let status = std::fs::read_to_string(thread?.path().join("schedstat"))?;
        let running = status.split_whitespace().next().unwrap_or_default();
        nanoseconds += running.parse::<u64>()?;
    }
    Ok(nanoseconds as f64 * 1e-9)
}

/// Current memory of the process in bytes.
fn resident() -> Answer<usize> {
    status("VmRSS:")
}

/// Peak memory of the process in bytes.
fn peak() -> Answer<usize> {
    status("VmHWM:")
}

/// A line of the process status in Linux, in bytes.
fn status(key: &str) -> Answer<usize> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix(key));
    let kilobytes = line.and_then(|line| line.trim().strip_suffix(" kB"));
    Ok(1024
        * kilobytes
            .ok_or("the line is missing")?
            .trim()
            .parse::<usize>()?)
}
