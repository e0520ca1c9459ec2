//! Compares the times of the convolution, of products with the floor and of one-pillar problems on one thread with the theoretical minimum
//! for this machine: `cargo run --release -p fakir --features kernels --example limits`.
//!
//! The minimum is the longer of two times: all operations at the rate of multiplications and additions in registers, twice as fast in
//! single precision, and all bytes at the rate of a copy of arrays of this size.

use fakir::kernels::{byte_rate, limits, operation_rate};

fn main() {
    let rate = operation_rate();
    println!(
        "operations in registers: {:.1} billion a second",
        rate * 1e-9
    );
    println!();
    println!(
        "| work | operations | bytes | floor by operations, s | floor by bytes, s | measured, s | over the \
         floor | transforms alone, s |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for limit in limits(&[500.0, 3.5e3, 1e5, 1e6]) {
        let by_operations = limit.operations / (rate * limit.at_once);
        let by_bytes = if limit.bytes > 0.0 {
            limit.bytes / byte_rate(limit.working_set)
        } else {
            0.0
        };
        println!(
            "| {} | {:.2e} | {:.2e} | {:.2e} | {:.2e} | {:.2e} | {:.1} | {} |",
            limit.name,
            limit.operations,
            limit.bytes,
            by_operations,
            by_bytes,
            limit.seconds,
            limit.seconds / by_operations.max(by_bytes),
            limit
                .transforms
                .map_or_else(String::new, |time| format!("{time:.2e}")),
        );
    }
}
