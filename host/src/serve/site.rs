//! The addresses of the server.

use super::access::Access;
use super::machine::Machine;
use super::{page, program_file, socket};
use axum::Router;
use axum::body::Bytes;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{DefaultBodyLimit, Path, Query, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use serde::Deserialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use tokio::sync::watch;

/// Longest frame of a client, bytes.
const FRAME: usize = 64 * 1024;
/// Clients at a time.
const CLIENTS: usize = 64;

/// What all requests share.
#[derive(Debug)]
pub struct Site {
    access: Arc<Access>,
    /// The machines, in the order of their numbers.
    pub machines: Vec<Arc<Machine>>,
    /// Changes with each new state or line of a console.
    pub news: watch::Sender<u64>,
    next_client: AtomicU64,
    clients: AtomicUsize,
}

/// The part of an address that has the token.
#[derive(Debug, Default, Deserialize)]
struct Token {
    token: Option<String>,
    /// Name of a program.
    name: Option<String>,
    /// Index of a tool of a program.
    tool: Option<usize>,
}

/// The server for these machines.
pub fn router(
    access: Arc<Access>,
    machines: Vec<Arc<Machine>>,
    news: watch::Sender<u64>,
) -> Router {
    let site = Arc::new(Site {
        access,
        machines,
        news,
        next_client: AtomicU64::new(1),
        clients: AtomicUsize::new(0),
    });
    Router::new()
        .route("/", get(|| async { page::file("") }))
        .route("/machines", get(list))
        .route("/machines/{number}/{part}", get(part).post(load))
        .layer(DefaultBodyLimit::max(program_file::MOST_BYTES))
        .route("/socket", get(open))
        .route("/{*path}", get(file))
        .layer(middleware::from_fn_with_state(Arc::clone(&site), checked))
        .with_state(site)
}

/// Refuses requests of other sites, and adds the headers of every answer.
async fn checked(State(site): State<Arc<Site>>, request: Request, next: Next) -> Response {
    let mut answer = match site.access.of_page(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    };
    for (name, value) in page::headers() {
        answer.headers_mut().entry(name).or_insert(value);
    }
    answer
}

async fn file(Path(path): Path<String>) -> Response {
    page::file(&path)
}

async fn list(
    State(site): State<Arc<Site>>,
    Query(query): Query<Token>,
    headers: HeaderMap,
) -> Response {
    match site.access.of_machine(&headers, query.token.as_deref()) {
        Ok(()) => {
            let list = serde_json::Value::Array(site.described());
            let json = [(header::CONTENT_TYPE, "application/json")];
            (json, list.to_string()).into_response()
        }
        Err(refusal) => refusal.into_response(),
    }
}

/// The machine of an address, if the request has the token.
fn machine(
    site: &Site,
    number: u32,
    query: &Token,
    headers: &HeaderMap,
) -> Result<Arc<Machine>, Box<Response>> {
    let permitted = site.access.of_machine(headers, query.token.as_deref());
    permitted.map_err(|refusal| Box::new(refusal.into_response()))?;
    let found = site.machines.iter().find(|one| one.number == number);
    let none = || {
        let answer = (StatusCode::NOT_FOUND, "there is no such machine\n");
        Box::new(answer.into_response())
    };
    found.cloned().ok_or_else(none)
}

/// What a machine has: the text of its program, the scene of it, or the report of the last run.
async fn part(
    State(site): State<Arc<Site>>,
    Path((number, part)): Path<(u32, String)>,
    Query(query): Query<Token>,
    headers: HeaderMap,
) -> Response {
    match (machine(&site, number, &query, &headers), part.as_str()) {
        (Err(refusal), _) => *refusal,
        (Ok(machine), "program") => program_file::text(&machine),
        (Ok(machine), "scene") => program_file::scene(&machine),
        (Ok(machine), "report") => program_file::report(&machine).await,
        (Ok(machine), "board") => program_file::board(&machine),
        (Ok(machine), "records") => program_file::records(&machine, query.tool.unwrap_or(0)),
        _ => no_part(),
    }
}

fn no_part() -> Response {
    (StatusCode::NOT_FOUND, "a machine has no such part\n").into_response()
}

async fn load(
    State(site): State<Arc<Site>>,
    Path((number, part)): Path<(u32, String)>,
    Query(query): Query<Token>,
    headers: HeaderMap,
    body: Bytes,
) -> Response {
    let machine = match machine(&site, number, &query, &headers) {
        Ok(machine) => machine,
        Err(refusal) => return *refusal,
    };
    if part != "program" {
        return no_part();
    }
    let client = headers
        .get("x-husillo-client")
        .and_then(|value| value.to_str().ok()?.parse().ok());
    let name = query.name.unwrap_or_else(|| "program.nc".into());
    // No client has this number.
    program_file::load(machine, client.unwrap_or(u64::MAX), name, body).await
}

async fn open(
    State(site): State<Arc<Site>>,
    Query(query): Query<Token>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if let Err(refusal) = site.access.of_machine(&headers, query.token.as_deref()) {
        return refusal.into_response();
    }
    let Some(place) = Place::take(&site) else {
        let why = "too many pages are open: close one\n";
        return (StatusCode::SERVICE_UNAVAILABLE, why).into_response();
    };
    upgrade
        .max_message_size(FRAME)
        .max_frame_size(FRAME)
        .on_upgrade(async move |web_socket| {
            let client = site.next_client.fetch_add(1, Ordering::Relaxed);
            socket::serve(&site, client, web_socket).await;
            drop(place);
        })
}

/// The place of one client. It is free again when this is dropped.
struct Place(Arc<Site>);

impl Place {
    fn take(site: &Arc<Site>) -> Option<Self> {
        let place = Self(Arc::clone(site));
        // The place is counted, and given back if it is one too many.
        (site.clients.fetch_add(1, Ordering::Relaxed) < CLIENTS).then_some(place)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Site {
    /// What a page is told about the machines at first.
    pub fn described(&self) -> Vec<serde_json::Value> {
        self.machines.iter().map(|one| one.described()).collect()
    }
}
