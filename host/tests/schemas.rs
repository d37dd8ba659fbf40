//! Everything that `--format json` prints is as its schema has it, and a schema has no more.

mod common;

use common::husillo;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Commands that together print everything that the schemas have.
const COMMANDS: [&str; 81] = [
    "check tests/data/errors.nc",
    "check ../examples/circles.nc -m micromill",
    "check ../examples/thread.nc ../examples/gear.nc -m lathe",
    "check tests/data/drill/faults.drl",
    "check tests/data/outside.nc -m router --zero X0",
    "run ../examples/circles.nc",
    "run ../examples/circles.nc --order mirrored --symmetry 5",
    "run tests/data/errors.nc -m free",
    "run tests/data/json/probing.nc -m router --zero X20Y20Z0",
    "run ../examples/circles.nc -m tests/data/json/encoder.toml --lose x:20000:-8",
    "commands tests/data/json/kinds.nc",
    "commands tests/data/json/holes.pcb --dialect drill",
    "commands tests/data/errors.nc",
    "commands tests/data/json/board.cod",
    "compare circle --radius 30",
    "compare line --to 100,40,3",
    "compare ../examples/gear.nc -m micromill",
    "compare motion ../examples/spirograph.nc -m router",
    "holes ../examples/board.drl",
    "holes tests/data/drill/rout.drl",
    "holes tests/data/drill/faults.drl",
    "holes tests/data/drill/tango.drl --profile tango",
    "holes tests/data/json/curved.drl",
    "holes ../examples/board.drl --as drill --shift corner --only 1",
    "interpolate line --to 10,4,3",
    "interpolate line --to 10,4 --method dda-printed",
    "interpolate arc --from 30,0 --to 30,0 --centre 0,0 --direction ccw",
    "machines",
    "machines show micromill",
    "machines show router",
    "machines show microfactory",
    "machines show lathe",
    "machines show cmm",
    "machines show cmm3",
    "measure -m cmm goto 1200 touch + zero status home jog + 0.1s --contact 1:3018 --pretravel 18",
    "measure -m cmm3 goto X1 Y2 Z-3 touch -z touch +x status --contact 1:2000 --contact 3:..-2000",
    "measure -m cmm calibrate + --reference 3000 --contact 1:3018",
    "measure -m cmm3 --piece ../examples/piece.toml --ball 1 run ../examples/piece.routine",
    "measure -m cmm3 --piece ../examples/piece.toml goto X20 Y20 Z-15 touch -z --repeat 3",
    "tune --method step",
    "tune --method relay --moves 2",
    "tune --method ultimate",
    "tune --method stepwise --moves 2",
    "reproduce microfactory 4.3",
    "reproduce cmm",
    "reproduce drill",
    "check no-such.nc",
    "measure -m cmm3 home x where",
    "measure -m cmm where",
    "measure -m cmm3 --piece ../examples/piece.toml goto Z-8 calibrate sphere X-25 Y25 Z-20 R10 \
     goto Z5 goto X20 Y20 goto Z-15 touch -z calibrate -z --reference -20",
    "explain E0302 g83",
    "steps ../examples/circles.nc -o /dev/null",
    "steps tests/data/errors.nc -m free -o /dev/null",
    "format --check ../examples/circles.nc tests/data/errors.nc",
    "format ../examples/circles.nc -o /dev/null",
    "format ../examples/circles.nc --to grbl -o /dev/null",
    "compile ../examples/board.drl -m drill --order shortest --shift corner --report /dev/null",
    "compile ../examples/board.drl -m drill --shift corner --only 1 -o {cod}",
    "compile tests/data/errors.nc -m micromill -o /dev/null",
    "compile ../examples/circles.nc -m micromill -o /dev/null",
    "compile ../examples/microfactory/square.nc -m microfactory -o /dev/null",
    "compile ../examples/microfactory/square.nc -m microfactory",
    "send ../examples/circles.nc -m micromill",
    "send ../examples/board.drl -m drill --shift corner --yes",
    "send - -m micromill",
    "send ../examples/board.drl -m drill --shift corner",
    "send ../examples/microfactory/square.nc -m microfactory",
    "send tests/data/errors.nc -m micromill",
    "send ../examples/circles.nc -m grbl",
    "jog home x 400",
    "jog -m micromill home where x 99999999",
    "jog -m drill home x 300 where",
    "jog --port /dev/null home",
    "stop -m micromill --port sim",
    "calibrate circles",
    "calibrate axis tests/data/json/gauge.csv",
    "calibrate squareness tests/data/json/bar.csv",
    "calibrate backlash tests/data/json/lines.csv",
    "emulate micromill --listen 127.0.0.1:0 --for 0.1",
    "serve --listen 127.0.0.1:0 --for 0.1",
    "machines write router {scratch}",
];

/// The schemas that the program prints, with their names.
fn schemas() -> BTreeMap<String, Value> {
    let names = common::printed(&["schema"]);
    let read = |name: &str| {
        let schema = common::printed(&["schema", name]);
        (name.to_owned(), serde_json::from_str(&schema).unwrap())
    };
    names.lines().map(read).collect()
}

/// Objects of all commands, one a line. Each begins with its schema.
fn objects() -> Vec<(&'static str, Value)> {
    let mut objects = Vec::new();
    for command in COMMANDS {
        let scratch = common::scratch("schemas.toml");
        let _ = std::fs::remove_file(&scratch);
        let command_line = command.replace("{scratch}", scratch.to_str().unwrap());
        let cod = common::scratch("schemas.cod");
        let command_line = command_line.replace("{cod}", cod.to_str().unwrap());
        let words = command_line.split(' ').chain(["--format", "json"]);
        let mut program = husillo();
        program.args(words).write_stdin("G0 X1\nM30\n");
        let output = program.output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(!text.is_empty(), "{command}");
        for line in text.lines() {
            assert!(
                line.starts_with("{\"schema\":\"husillo."),
                "{command}: {line}"
            );
            let object = serde_json::from_str(line);
            objects.push((
                command,
                object.unwrap_or_else(|_| panic!("{command}: {line}")),
            ));
        }
    }
    objects
}

/// Keeps which properties of a schema an object has.
fn mark(schema: &Value, object: &Value, path: &str, seen: &mut BTreeSet<String>) {
    for one in schema["oneOf"].as_array().into_iter().flatten() {
        let kind = &one["properties"]["kind"]["const"];
        if *kind == object["kind"] {
            mark(one, object, &format!("{path}/{kind}"), seen);
        }
    }
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        if let Some(value) = object.get(name) {
            let path = format!("{path}.{name}");
            mark(property, value, &path, seen);
            seen.insert(path);
        }
    }
    for item in object.as_array().into_iter().flatten() {
        mark(&schema["items"], item, path, seen);
    }
}

/// All properties of a schema.
fn properties(schema: &Value, path: &str, all: &mut BTreeSet<String>) {
    for one in schema["oneOf"].as_array().into_iter().flatten() {
        let kind = &one["properties"]["kind"]["const"];
        properties(one, &format!("{path}/{kind}"), all);
    }
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        let path = format!("{path}.{name}");
        properties(property, &path, all);
        all.insert(path);
    }
    if schema["items"].is_object() {
        properties(&schema["items"], path, all);
    }
}

#[test]
fn every_object_is_as_its_schema_has_it() {
    let schemas = schemas();
    let mut all = BTreeSet::new();
    let mut seen = BTreeSet::new();
    let validators: BTreeMap<&str, _> = (schemas.iter())
        .map(|(name, schema)| {
            properties(schema, name, &mut all);
            assert_eq!(schema["$id"], format!("husillo.{name}/1"));
            let mut schema = schema.clone();
            // A name, not an address.
            schema.as_object_mut().unwrap().remove("$id");
            (name.as_str(), jsonschema::validator_for(&schema).unwrap())
        })
        .collect();
    let mut wrong = Vec::new();
    for (command, object) in objects() {
        let schema = object["schema"].as_str().unwrap();
        let name = &schema["husillo.".len()..schema.len() - "/1".len()];
        for error in validators[name].iter_errors(&object) {
            wrong.push(format!("{command}: {}: {error}", error.instance_path()));
        }
        mark(&schemas[name], &object, name, &mut seen);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let unseen: Vec<_> = all
        .difference(&seen)
        .filter(|path| !is_rare(path))
        .collect();
    assert!(unseen.is_empty(), "no command prints {unseen:?}");
}

/// Properties that need a machine which fails or is driven by another program, or both kinds of
/// feed for each kind of move.
fn is_rare(path: &str) -> bool {
    let kinds = [
        "jog/\"failed\"",
        "stop/\"holder\"",
        "stop/\"axis\"",
        "stop/\"report\"",
        "stop/\"failed\"",
        "emulate/\"report\"",
        "compile/\"note\"",
        "send/\"note\"",
    ];
    if kinds.iter().any(|kind| path.starts_with(kind)) {
        return true;
    }
    path.contains(".feed_nm_per_") || path.ends_with(".aborted") || path.ends_with(".trouble")
}

/// An object is no object of its schema with a property more, or with one less.
#[test]
fn a_schema_refuses_other_objects() {
    let schema = schemas().remove("interpolate").unwrap();
    let object = common::json(&["interpolate", "line", "--to", "3,4", "--format", "json"]);
    let is_valid = |object: &Value| {
        let mut schema = schema.clone();
        schema.as_object_mut().unwrap().remove("$id");
        jsonschema::is_valid(&schema, object)
    };
    assert!(is_valid(&object));
    let names: Vec<_> = object.as_object().unwrap().keys().cloned().collect();
    for name in names {
        let mut less = object.clone();
        less.as_object_mut().unwrap().remove(&name);
        assert!(!is_valid(&less), "{name}");
    }
    let mut more = object;
    more["other"] = 1.into();
    assert!(!is_valid(&more));
}

#[test]
fn an_unknown_schema_is_named() {
    let output = husillo().args(["schema", "nosuch"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&output.stderr)
            .contains("no schema `nosuch`: there are calibrate.axis")
    );
}
