//! Payloads of Sparkplug B: the messages of its protobuf that an edge node needs.
//!
//! Source: Eclipse Sparkplug Specification 3.0, chapter 6.

use prost::{Message, Oneof};

/// A payload.
#[derive(Clone, PartialEq, Message)]
pub struct Payload {
    /// Time at which it was made, ms since 1970 in UTC.
    #[prost(uint64, optional, tag = "1")]
    pub timestamp: Option<u64>,
    /// Its values.
    #[prost(message, repeated, tag = "2")]
    pub metrics: Vec<Metric>,
    /// Its number: 0 to 255.
    #[prost(uint64, optional, tag = "3")]
    pub seq: Option<u64>,
}

/// A value with its name.
#[derive(Clone, PartialEq, Message)]
pub struct Metric {
    /// Its name.
    #[prost(string, optional, tag = "1")]
    pub name: Option<String>,
    /// Time of the value, ms since 1970 in UTC.
    #[prost(uint64, optional, tag = "3")]
    pub timestamp: Option<u64>,
    /// Its type, a [`Type`].
    #[prost(uint32, optional, tag = "4")]
    pub datatype: Option<u32>,
    /// It has no value.
    #[prost(bool, optional, tag = "7")]
    pub is_null: Option<bool>,
    /// What else is known of it.
    #[prost(message, optional, tag = "9")]
    pub properties: Option<Properties>,
    /// Its value.
    #[prost(oneof = "Value", tags = "10, 11, 12, 13, 14, 15, 16")]
    pub value: Option<Value>,
}

/// A value.
#[derive(Clone, PartialEq, Oneof)]
pub enum Value {
    /// Of at most 32 bits.
    #[prost(uint32, tag = "10")]
    Int(u32),
    /// Of 64 bits.
    #[prost(uint64, tag = "11")]
    Long(u64),
    /// A short real number.
    #[prost(float, tag = "12")]
    Float(f32),
    /// A real number.
    #[prost(double, tag = "13")]
    Double(f64),
    /// Yes or no.
    #[prost(bool, tag = "14")]
    Boolean(bool),
    /// A text.
    #[prost(string, tag = "15")]
    Text(String),
    /// A file.
    #[prost(bytes = "vec", tag = "16")]
    Bytes(Vec<u8>),
}

/// Properties of a metric, as two lists of the same length.
#[derive(Clone, PartialEq, Message)]
pub struct Properties {
    /// Names.
    #[prost(string, repeated, tag = "1")]
    pub keys: Vec<String>,
    /// Values.
    #[prost(message, repeated, tag = "2")]
    pub values: Vec<Property>,
}

/// The value of a property that is a text.
#[derive(Clone, PartialEq, Message)]
pub struct Property {
    /// Its type, a [`Type`].
    #[prost(uint32, optional, tag = "1")]
    pub kind: Option<u32>,
    /// The text.
    #[prost(string, optional, tag = "8")]
    pub text: Option<String>,
}

/// Types of values, with their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// Integer of 64 bits.
    Int64 = 4,
    /// Natural number of 32 bits.
    UInt32 = 7,
    /// Real number.
    Double = 10,
    /// Yes or no.
    Boolean = 11,
    /// Text.
    String = 12,
}

impl Metric {
    /// A value that may be missing.
    pub fn new(name: impl Into<String>, datatype: Type, value: Option<Value>) -> Self {
        Self {
            name: Some(name.into()),
            timestamp: None,
            datatype: Some(datatype as u32),
            is_null: value.is_none().then_some(true),
            properties: None,
            value,
        }
    }

    /// The same with a unit.
    pub fn with_unit(mut self, unit: &str) -> Self {
        self.properties = Some(Properties {
            keys: vec!["engUnit".into()],
            values: vec![Property {
                kind: Some(Type::String as u32),
                text: Some(unit.into()),
            }],
        });
        self
    }
}

impl Payload {
    /// The value with this name.
    pub fn value(&self, name: &str) -> Option<&Value> {
        let mut metrics = self.metrics.iter();
        let found = metrics.find(|metric| metric.name.as_deref() == Some(name));
        found?.value.as_ref()
    }

    /// The text with this name.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.value(name)? {
            Value::Text(text) => Some(text),
            Value::Bytes(bytes) => std::str::from_utf8(bytes).ok(),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that were written by hand from the specification.
    #[test]
    fn the_bytes_are_those_of_the_specification() {
        let payload = Payload {
            timestamp: Some(1),
            metrics: vec![Metric::new("a", Type::Boolean, Some(Value::Boolean(true)))],
            seq: Some(2),
        };
        let metric = [0x0A, 1, b'a', 0x20, 11, 0x70, 1];
        let mut bytes = vec![0x08, 1, 0x12, metric.len() as u8];
        bytes.extend(metric);
        bytes.extend([0x18, 2]);
        assert_eq!(payload.encode_to_vec(), bytes);
        assert_eq!(Payload::decode(&bytes[..]).unwrap(), payload);
        assert_eq!(payload.value("a"), Some(&Value::Boolean(true)));
        let nothing = Metric::new("b", Type::Double, None);
        assert_eq!(nothing.encode_to_vec(), [0x0A, 1, b'b', 0x20, 10, 0x38, 1]);
        for bytes in [&[0x12, 200][..], &[0xFF; 20], &[0x12, 3, 0x0A, 1, 0xFF]] {
            assert!(Payload::decode(bytes).is_err(), "{bytes:?}");
        }
    }
}
