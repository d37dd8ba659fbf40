//! The list of modules of `husillo emulate`.

use husillo_metrology::simulated::{DcMotorModel, NetworkModule};
use husillo_transports::nmc::LAST_ADDRESS;

/// Reads modules from a list such as `servo:4,io:2`. The farthest module comes first. `motor` gives
/// the motor of the servo module with this address.
///
/// # Errors
///
/// A module is unknown, or there are too many.
pub fn modules(
    list: &str,
    motor: impl Fn(u8) -> DcMotorModel,
) -> Result<Vec<NetworkModule>, String> {
    let names: Vec<&str> = list.split(',').map(str::trim).collect();
    if names.len() > usize::from(LAST_ADDRESS) {
        return Err(format!(
            "{} modules: a line has at most {LAST_ADDRESS}",
            names.len()
        ));
    }
    let module = |(name, address): (&&str, u8)| {
        let (kind, version) = match name.split_once(':') {
            Some((kind, version)) => (kind, version.parse::<u8>().ok()),
            None if *name == "io" => (*name, Some(2)),
            None => (*name, Some(4)),
        };
        match (kind, version) {
            ("servo", Some(version @ (4 | 5 | 10))) => Ok(NetworkModule::Servo {
                version,
                motor: motor(address),
            }),
            ("io", Some(version)) => Ok(NetworkModule::Io { version }),
            _ => Err(format!(
                "`{name}`: expected servo:4, servo:5, servo:10 or io:VERSION, separated by commas"
            )),
        }
    };
    names.iter().zip(1..).map(module).collect()
}

#[cfg(test)]
mod tests {
    use super::{DcMotorModel, NetworkModule, modules};

    const MOTOR: DcMotorModel = DcMotorModel::PROTOTYPE;

    /// Kind and version of each module, and the counts per revolution of its motor.
    fn read(list: &str) -> Result<Vec<(&'static str, u8, u32)>, String> {
        let motor = |address: u8| DcMotorModel {
            counts_per_revolution: u32::from(address),
            ..MOTOR
        };
        let read = modules(list, motor)?;
        let read = read.iter().map(|module| match *module {
            NetworkModule::Servo { version, motor } => {
                ("servo", version, motor.counts_per_revolution)
            }
            NetworkModule::Io { version } => ("io", version, 0),
        });
        Ok(read.collect())
    }

    #[test]
    fn kinds_and_versions_in_the_order_of_the_addresses() {
        assert_eq!(
            read("servo:4,io:2"),
            Ok(vec![("servo", 4, 1), ("io", 2, 0)])
        );
        assert_eq!(
            read("io, servo, servo:10"),
            Ok(vec![("io", 2, 0), ("servo", 4, 2), ("servo", 10, 3)])
        );
    }

    #[test]
    fn unknown_modules_and_long_lines_are_refused() {
        for list in [
            "",
            "servo:6",
            "io:300",
            "io:x",
            "step:1",
            "servo:4;io:2",
            "servo,",
        ] {
            let error = read(list).unwrap_err();
            assert!(error.contains("expected servo:4"), "{list}: {error}");
        }
        let many = ["servo"; 33].join(",");
        assert_eq!(
            read(&many).unwrap_err(),
            "33 modules: a line has at most 32"
        );
    }
}
