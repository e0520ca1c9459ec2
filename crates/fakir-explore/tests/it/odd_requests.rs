//! Responses of a server to meaningless requests. The test has a separate process, because its memory is
//! measured.

use crate::running::{Running, case, question};
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use serde_json::{Value, json};
use std::io::{Read, Write};

/// 10,000 requests, hardly any of which is valid.
#[test]
fn ten_thousand_odd_requests_leave_it_as_it_was() {
    if !runs_alone("odd_requests::ten_thousand_odd_requests_leave_it_as_it_was") {
        return;
    }
    let server = Running::start();
    let headers = [
        ("content-type", "application/json"),
        ("x-fakir-token", server.token.as_str()),
    ];
    let good = question(1, &case(0.001)).to_string();
    let good = server.request("/api/contact", &good, &headers);
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut odd = |server: &Running, number: u64| {
        let mut bytes = match random.next_u32() % 4 {
            0 => {
                let length = random.next_u32() as usize % 600;
                (0..length).map(|_| random.next_u32() as u8).collect()
            }
            1 => {
                let text = odd_json(&mut random, 0).to_string();
                server.request("/api/contact", &text, &headers).into_bytes()
            }
            2 => {
                let mut asked = question(number, &case(0.001));
                let keys = [
                    "lens.radius",
                    "pattern.pillar.height",
                    "method.name",
                    "nothing",
                ];
                let key = keys[random.next_u32() as usize % keys.len()];
                asked["case"][key] = odd_json(&mut random, 2);
                server
                    .request("/api/curves", &asked.to_string(), &headers)
                    .into_bytes()
            }
            _ => good.clone().into_bytes(),
        };
        for _ in 0..random.next_u32() % 8 {
            if let Some(at) = (random.next_u32() as usize).checked_rem(bytes.len()) {
                bytes[at] = random.next_u32() as u8;
            }
        }
        let mut stream = server.connect();
        let _ = stream.write_all(&bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        if !number.is_multiple_of(3) {
            let mut answer = Vec::new();
            let _ = stream.read_to_end(&mut answer);
            let answer = String::from_utf8_lossy(&answer);
            assert!(!answer.contains(" 500 "), "{answer}");
        }
    };
    let mut used = Vec::new();
    for number in 0..10_000 {
        odd(&server, number);
        if number % 2000 == 1999 {
            used.push(resident_memory());
        }
    }
    let answer = server.ask("/api/contact", &question(20_000, &case(0.001)));
    assert_eq!(answer.status, 200);
    if let (Some(Some(first)), Some(Some(last))) = (used.first(), used.last()) {
        // kB; allocators retain some memory.
        assert!(*last < first + 30_000, "{used:?}");
    }
}

/// JSON with an unexpected content.
fn odd_json(random: &mut ChaCha8Rng, depth: usize) -> Value {
    match random.next_u32() % if depth < 3 { 8 } else { 6 } {
        0 => Value::Null,
        1 => json!(f64::from_bits(random.next_u64())),
        2 => json!(random.next_u64()),
        3 => json!("\u{0}\"\\\n[lens]\n".repeat(random.next_u32() as usize % 9)),
        4 => json!(random.next_u32().is_multiple_of(2)),
        5 => json!("2.2 mm"),
        6 => (0..random.next_u32() % 5)
            .map(|_| odd_json(random, depth + 1))
            .collect(),
        _ => {
            let names = [
                "ticket",
                "case",
                "load",
                "session",
                "sequence",
                "lens.radius",
            ];
            let member = |k: usize, random: &mut ChaCha8Rng| {
                (names[k].to_owned(), odd_json(random, depth + 1))
            };
            let count = random.next_u32() as usize % names.len();
            Value::Object((0..count).map(|k| member(k, random)).collect())
        }
    }
}

/// Whether this process runs a single test; if not, runs the test in a separate process. Memory is measured for a
/// whole process, and other tests run at the same time.
fn runs_alone(test: &str) -> bool {
    if std::env::var_os("FAKIR_ONE_TEST").is_some() {
        return true;
    }
    let status = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", test])
        .env("FAKIR_ONE_TEST", "1")
        .status();
    assert!(status.unwrap().success(), "{test}");
    false
}

/// Memory of this process, kB, if available.
fn resident_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
