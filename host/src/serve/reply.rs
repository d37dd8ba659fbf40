//! The answer to a request of a page.

use axum::extract::ws::Utf8Bytes;
use serde_json::{Value, json};
use tokio::sync::mpsc::Sender;

/// Where the answer to a request goes.
#[derive(Debug)]
pub struct Reply {
    id: Value,
    to: Sender<Utf8Bytes>,
}

impl Reply {
    /// The answer to the request `id` of a client. Null: success is not answered.
    pub const fn new(id: Value, to: Sender<Utf8Bytes>) -> Self {
        Self { id, to }
    }

    /// The request was carried out.
    pub fn ok(self) {
        self.data(Value::Null);
    }

    /// The request was carried out, with a result.
    pub fn data(self, data: Value) {
        if !self.id.is_null() {
            let id = self.id;
            send(
                &self.to,
                &json!({"kind": "answer", "id": id, "ok": true, "data": data}),
            );
        }
    }

    /// The request was refused, or has failed.
    pub fn error(self, why: impl AsRef<str>) {
        let (id, why) = (self.id, why.as_ref());
        send(
            &self.to,
            &json!({"kind": "answer", "id": id, "ok": false, "error": why}),
        );
    }

    /// Answers with data or an error.
    pub fn result(self, result: Result<Value, String>) {
        match result {
            Ok(data) => self.data(data),
            Err(why) => self.error(why),
        }
    }

    /// Answers with a result or an error.
    pub fn with(self, result: Result<(), impl AsRef<str>>) {
        match result {
            Ok(()) => self.ok(),
            Err(why) => self.error(why),
        }
    }
}

/// Sends an answer. A client for which too many answers wait does not read: its socket notices
/// that and closes, because the queue is full.
fn send(to: &Sender<Utf8Bytes>, frame: &Value) {
    let _ = to.try_send(frame.to_string().into());
}
