//! The server as seen from outside, over real sockets of this machine.

use crate::running::{Running, case, options, question};
use fakir::problem::Method;
use fakir::state::Run;
use fakir_case::Case;
use fakir_explore::{ExploreError, Explorer};
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

#[test]
fn the_page_needs_its_token_and_nothing_from_elsewhere() {
    let server = Running::start();
    let page = server.get(&format!("/{}/", server.token), &[]);
    assert_eq!(page.status, 200);
    assert!(
        page.head
            .contains("content-security-policy: default-src 'none'"),
        "{}",
        page.head
    );
    assert!(page.head.contains("cache-control: no-store"));
    assert!(!page.body.contains("http://") && !page.body.contains("https://"));
    for file in ["main.js", "style.css", "font.css", "start.json"] {
        assert_eq!(
            server.get(&format!("/{}/{file}", server.token), &[]).status,
            200,
            "{file}"
        );
    }
    assert_eq!(
        server
            .get(&format!("/{}/none.js", server.token), &[])
            .status,
        404
    );
    let wrong = "0".repeat(32);
    for path in [
        "/",
        &format!("/{wrong}/"),
        &format!("/{wrong}/main.js"),
        "/../",
        "//",
    ] {
        assert_eq!(server.get(path, &[]).status, 403, "{path}");
    }
}

#[test]
fn other_origins_hosts_and_methods_are_refused() {
    let server = Running::start();
    let body = || question(server.next(), &case(0.01)).to_string();
    let own = format!("127.0.0.1:{}", server.port);
    let json = ("content-type", "application/json");
    let token = ("x-fakir-token", server.token.as_str());
    let status = |headers: &[(&str, &str)]| server.post("/api/contact", &body(), headers).status;
    assert_eq!(status(&[json, token]), 200);
    assert_eq!(
        status(&[json, token, ("origin", &format!("http://{own}"))]),
        200
    );
    for origin in [
        "http://example.org",
        "null",
        "https://127.0.0.1",
        &format!("https://{own}"),
    ] {
        assert_eq!(status(&[json, token, ("origin", origin)]), 403, "{origin}");
    }
    for host in [
        "example.org",
        &format!("example.org:{}", server.port),
        "127.0.0.1",
        "127.0.0.1:1",
    ] {
        assert_eq!(status(&[json, token, ("host", host)]), 403, "{host}");
    }
    assert_eq!(status(&[json]), 403);
    assert_eq!(
        status(&[json, ("x-fakir-token", "0123456789abcdef0123456789abcdef")]),
        403
    );
    assert_eq!(status(&[json, token, token]), 403);
    assert_eq!(status(&[("content-type", "text/plain"), token]), 415);
    assert_eq!(server.get("/api/contact", &[token]).status, 405);
    assert_eq!(
        server.post("/api/nothing", &body(), &[json, token]).status,
        405
    );
    let large = format!("{}{}", body(), " ".repeat(1_100_000));
    assert_eq!(
        server.post("/api/contact", &large, &[json, token]).status,
        413
    );
}

#[test]
fn answers_are_those_of_the_library() {
    let server = Running::start();
    let critical = fakir::transition(
        &{
            let mut file = fakir_case::CaseFile::parse("case", &Case::example().to_toml()).unwrap();
            file.set("pattern.surface_fraction=0.01").unwrap();
            file.case().unwrap().system
        },
        Method::default(),
        &Run::default(),
    )
    .unwrap();
    let answer = server.ask("/api/contact", &question(1, &case(0.01)));
    let summary = &answer.line("critical");
    assert_eq!(summary["critical_force_N"], json!(critical.contact.force));
    assert_eq!(
        summary["critical_indentation_m"],
        json!(critical.contact.indentation)
    );
    assert_eq!(
        summary["critical_contact_radius_m"],
        json!(critical.contact_radius())
    );
    let state = answer.line("state");
    let forces: Vec<f64> = critical.contact.pillars.iter().map(|p| p.force).collect();
    assert_eq!(state["pillar_forces_N"], json!(forces));
    // The state is sent before its errors are estimated; the errors follow.
    let errors = |summary: &Value| summary["relative_error_estimate"]["force"].clone();
    assert_eq!(errors(&state["summary"]), Value::Null);
    assert_eq!(
        errors(&answer.line("summary")),
        json!(critical.contact.error.force)
    );
    assert_eq!(
        state["pillar_statuses"].as_str().unwrap().len(),
        forces.len()
    );
    let section = answer.line("section");
    let lowest = section["surface_m"].as_array().unwrap().len();
    assert_eq!(lowest, section["x_m"].as_array().unwrap().len());
    // By symmetry the first floor contacts are along x, on both sides of the lens axis.
    assert_eq!(section["floor_contacts_m"].as_array().unwrap().len(), 2);

    // Half-way from first contact, which is at 0 with a pillar under the lens axis.
    let mut half = question(2, &case(0.01));
    half["load"] = json!({ "fraction": 0.5 });
    let answer = server.ask("/api/contact", &half);
    assert_eq!(
        answer.line("state")["summary"]["indentation_m"],
        json!(0.5 * critical.contact.indentation)
    );
    assert_eq!(answer.line("section")["floor_contacts_m"], json!([]));
    let mut beyond = question(3, &case(0.01));
    beyond["load"] = json!({ "fraction": 1.2 });
    let state = server.ask("/api/contact", &beyond).line("state");
    assert_eq!(state["summary"]["beyond_transition"], json!(true));
}

/// A number that the page cannot send, such as 1e400, is sent as typed, or without a value.
#[test]
fn values_that_are_no_numbers_are_refused_in_plain_words() {
    let server = Running::start();
    let contact = |value: Value| {
        let mut values = case(0.01);
        values["lens.radius"] = value;
        let answer = server.ask("/api/contact", &question(server.next(), &values));
        assert!((400..500).contains(&answer.status), "{}", answer.status);
        answer.body
    };
    let infinite = contact(json!("1e400 um"));
    for words in ["\"key\":\"lens.radius\"", "greater than 0"] {
        assert!(infinite.contains(words), "{infinite}");
    }
    let none = contact(Value::Null);
    assert!(
        none.contains("a finite number in SI units, or a text such as"),
        "{none}"
    );
    assert!(!none.contains("untagged"), "{none}");
}

/// Past the transition the floor carries load, unless floor contact is ignored.
#[test]
fn past_the_transition_the_floor_carries_load() {
    let server = Running::start();
    let asked = |values: Value| {
        let mut beyond = question(server.next(), &values);
        beyond["load"] = json!({ "fraction": 1.8 });
        server.ask("/api/contact", &beyond)
    };
    let answer = asked(case(0.01));
    let state = answer.line("state");
    let (summary, floor) = (&state["summary"], &state["floor"]);
    let share = summary["floor"]["share"].as_f64().unwrap();
    assert!((0.05..0.9).contains(&share), "{share}");
    assert_eq!(state["floor_contacts_m"], json!([]));
    let cells: u64 = floor["segments"]
        .as_array()
        .unwrap()
        .chunks(3)
        .map(|segment| segment[2].as_u64().unwrap())
        .sum();
    assert_eq!(floor["shades"].as_str().unwrap().len() as u64, cells);
    assert!(
        !answer.line("section")["floor_m"]
            .as_array()
            .unwrap()
            .is_empty()
    );

    let mut ignored = case(0.01);
    ignored["floor.contact"] = json!("false");
    let answer = asked(ignored);
    let state = answer.line("state");
    assert_eq!(state["floor"], Value::Null);
    assert_eq!(state["summary"]["floor"], Value::Null);
    assert!(state["summary"]["smallest_floor_gap_m"].as_f64().unwrap() < 0.0);
    assert_eq!(answer.line("section")["floor_m"], json!([]));
    let python = answer.line("case")["python"].clone();
    assert!(python.as_str().unwrap().contains("floor_contact=False"));
}

/// The state with the pillar tops alone is sent first, because the floor takes longer.
#[test]
fn the_pillar_tops_alone_come_before_the_floor() {
    let server = Running::start();
    let mut beyond = question(server.next(), &case(0.07));
    beyond["load"] = json!({ "fraction": 1.1 });
    let lines = server.ask("/api/contact", &beyond).lines();
    let states: Vec<&Value> = lines.iter().filter_map(|line| line.get("state")).collect();
    let [tops, floor] = states[..] else {
        panic!("{} states", states.len());
    };
    assert_eq!(
        (&tops["approximate"], &tops["floor"]),
        (&json!(true), &Value::Null)
    );
    assert_eq!(floor["approximate"], json!(false));
    let force = |state: &Value| state["summary"]["force_N"].as_f64().unwrap();
    assert!(force(floor) > force(tops));
}

#[test]
fn curves_and_the_loading_path_come_point_by_point() {
    let server = Running::start();
    let mut soft = case(0.002);
    soft["method.name"] = json!("homogenised");
    let curves = server.ask("/api/curves", &question(1, &soft)).lines();
    assert!(
        curves[0]["formulas"]["large_contact"]
            .as_array()
            .unwrap()
            .len()
            > 10
    );
    let points = curves.iter().filter(|line| line.get("point").is_some());
    assert!(points.count() > 20);
    assert!(curves.last().unwrap().get("complete").is_some());
    let phase = server.ask("/api/phase", &question(2, &case(0.002))).lines();
    assert!(phase[0]["transition"].as_array().unwrap().len() > 100);
    let path: Vec<&Value> = phase.iter().filter_map(|line| line.get("path")).collect();
    assert_eq!(path.len(), 21);
    for state in path {
        let beyond = state["fraction"].as_f64().unwrap() > 1.0;
        assert_eq!(
            state["floor_force_N"].as_f64() > Some(0.0),
            beyond,
            "{state}"
        );
    }
}

#[test]
fn what_cannot_be_is_refused_at_its_key() {
    let server = Running::start();
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut asked = question(server.next(), &case(0.01));
        change(&mut asked);
        let answer = server.ask("/api/contact", &asked);
        let message: Value = serde_json::from_str(&answer.body).unwrap();
        (answer.status, message)
    };
    let (status, message) = refused(&|q| q["case"]["pattern.pillar.height"] = json!("5 mm"));
    assert_eq!(
        (status, &message["key"]),
        (422, &json!("pattern.pillar.height"))
    );
    assert_eq!(message["message"], "cannot be 5 mm");
    assert!(
        message["accepted"]
            .as_str()
            .unwrap()
            .contains("below the lens radius")
    );
    let (status, message) = refused(&|q| q["case"]["lens.radius"] = json!("2 MPa"));
    assert_eq!((status, &message["key"]), (422, &json!("lens.radius")));
    let (status, message) = refused(&|q| q["case"]["pattern.surface_fraction"] = json!(0.6));
    assert_eq!(
        (status, &message["key"]),
        (422, &json!("pattern.surface_fraction"))
    );
    assert!(
        message["accepted"].as_str().unwrap().contains("up to 0."),
        "{message}"
    );
    let (status, message) = refused(&|q| q["case"]["lens.raduis"] = json!(1.0));
    assert_eq!((status, &message["key"]), (422, &json!("lens.raduis")));
    let (status, message) = refused(&|q| q["load"] = json!({ "fraction": 7.0 }));
    assert_eq!((status, &message["key"]), (422, &json!("load.fraction")));
    let (status, _) = refused(&|q| q["extra"] = json!(1));
    assert_eq!(status, 400);
    let (status, _) = refused(&|q| q["ticket"]["session"] = json!("x".repeat(100)));
    assert_eq!(status, 400);
}

#[test]
fn files_are_those_of_the_command_line() {
    let server = Running::start();
    let file = |name: &str| {
        let mut asked = question(server.next(), &case(0.01));
        asked["file"] = json!(name);
        let answer = server.ask("/api/export", &asked);
        let message = || format!("{name}: {}\n{}", answer.head, answer.body);
        assert!(answer.status == 200, "{}", message());
        answer
    };
    let toml = file("case.toml").body;
    let read = fakir_case::CaseFile::parse("case.toml", &toml)
        .unwrap()
        .case()
        .unwrap();
    assert!((read.system.pattern().surface_fraction() - 0.01).abs() < 1e-15);
    let summary: Value = serde_json::from_str(&file("summary.json").body).unwrap();
    assert_eq!(summary["regime"], "top_first");
    let pillars = file("pillars.csv").body;
    assert!(
        pillars.starts_with("i,j,x_m,y_m,status,force_N,"),
        "{pillars}"
    );
    for figure in [
        "pressure-map",
        "profiles",
        "top-view",
        "floor-gap-map",
        "phase-diagram",
    ] {
        let svg = file(&format!("{figure}.svg"));
        assert!(svg.status == 200 && svg.body.contains("<svg"), "{figure}");
        assert!(
            file(&format!("{figure}.png")).head.contains("image/png"),
            "{figure}"
        );
    }
    let mut asked = question(server.next(), &case(0.01));
    asked["file"] = json!("../../etc/passwd");
    assert_eq!(server.ask("/api/export", &asked).status, 422);
}

#[test]
fn the_newest_request_calls_off_those_before() {
    let server = Running::start();
    let start = Instant::now();
    let slow = |sequence| {
        let mut rigid = case(0.22);
        rigid["substrate.young_modulus"] = json!(1e9);
        rigid["method.accuracy"] = json!("accurate");
        let body = question(sequence, &rigid).to_string();
        let headers = [
            ("content-type", "application/json"),
            ("x-fakir-token", server.token.as_str()),
        ];
        let mut stream = server.connect();
        let request = server.request("/api/contact", &body, &headers);
        stream.write_all(request.as_bytes()).unwrap();
        stream
    };
    let mut before: Vec<TcpStream> = (1..=6).map(slow).collect();
    std::thread::sleep(Duration::from_millis(200));
    // An older request that arrives late is refused immediately.
    let late = server.ask("/api/contact", &question(3, &case(0.01)));
    assert_eq!(late.status, 409);
    let newest = server.ask("/api/contact", &question(100, &case(0.01)));
    assert_eq!(newest.status, 200);
    for stream in &mut before {
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        // Estimates may have been sent, but not the result.
        assert!(!answer.contains("\"approximate\":false"), "{answer}");
    }
    // A request whose connection is closed is cancelled too; then an older one is accepted again.
    drop(slow(200));
    std::thread::sleep(Duration::from_millis(100));
    let older = || server.ask("/api/contact", &question(150, &case(0.01)));
    while older().status != 200 {
        assert!(start.elapsed() < Duration::from_secs(20));
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Two hundred connections that never complete their request, three times, each time before the page
/// is requested.
#[test]
fn idle_connections_do_not_block_others() {
    let server = Running::start();
    let page = format!("/{}/", server.token);
    let asked_before = server.get(&page, &[]).status;
    assert_eq!(asked_before, 200);
    let start = Instant::now();
    for _ in 0..3 {
        let half_open: Vec<TcpStream> = (0..200)
            .map(|_| {
                let mut stream = server.connect();
                // The server may have closed it in favour of others already.
                let _ = stream.write_all(b"GET / HTTP/1.1\r\nhost: ");
                stream
            })
            .collect();
        assert_eq!(server.get(&page, &[]).status, 200);
        let answer = server.ask("/api/contact", &question(server.next(), &case(0.01)));
        assert_eq!(answer.status, 200);
        drop(half_open);
    }
    // Without the limit, the server would wait each time for the ten seconds allowed for a request.
    assert!(
        start.elapsed() < Duration::from_secs(15),
        "{:?}",
        start.elapsed()
    );
}

#[test]
fn a_busy_port_is_named_with_a_free_one() {
    let first = Explorer::bind(&options(None)).unwrap();
    let address = first.address();
    let port: u16 = address.split([':', '/']).nth(4).unwrap().parse().unwrap();
    let error = Explorer::bind(&options(Some(port))).unwrap_err();
    let message = error.to_string();
    assert!(
        message.starts_with(&format!("port {port} is in use: port ")),
        "{message}"
    );
    let ExploreError::PortInUse { next_free, .. } = error else {
        panic!("{message}");
    };
    assert!(Explorer::bind(&options(next_free)).is_ok());
}
