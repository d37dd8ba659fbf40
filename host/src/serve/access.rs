//! Who may use the pages: the token of this run, the names of the host, and the origins.

use axum::http::{HeaderMap, StatusCode, header};
use std::fmt::Write as _;
use std::net::SocketAddr;

/// The token, and the hosts under which the server may be addressed.
#[derive(Debug)]
pub struct Access {
    token: String,
    address: SocketAddr,
    /// Values of the header `Host`.
    hosts: Vec<String>,
}

/// Why a request is refused.
pub type Refusal = (StatusCode, &'static str);

impl Access {
    /// A new token for a server at this address. `names` are further names of the host.
    ///
    /// # Errors
    ///
    /// The system has no random numbers.
    pub fn new(address: SocketAddr, names: &[String]) -> Result<Self, String> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|error| format!("random numbers: {error}"))?;
        let mut token = String::new();
        for byte in bytes {
            // Writing to a text does not fail.
            let _ = write!(token, "{byte:02x}");
        }
        let port = address.port();
        let mut hosts = vec![
            format!("127.0.0.1:{port}"),
            format!("localhost:{port}"),
            format!("[::1]:{port}"),
            address.to_string(),
        ];
        for name in names {
            hosts.extend([name.clone(), format!("{name}:{port}")]);
        }
        hosts
            .iter_mut()
            .for_each(|host| host.make_ascii_lowercase());
        Ok(Self {
            token,
            address,
            hosts,
        })
    }

    /// The address of the page for the operator. A browser does not send the part after `#`.
    pub fn link(&self) -> String {
        let address = match self.address.ip().is_unspecified() {
            true => format!("127.0.0.1:{}", self.address.port()),
            false => self.address.to_string(),
        };
        format!("http://{address}/#{}", self.token)
    }

    /// Permits a request that needs no token. Another page, and a name that leads here by a changed
    /// name server, are refused.
    ///
    /// # Errors
    ///
    /// The reason.
    pub fn of_page(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = text(headers, header::HOST);
        if !host.is_some_and(|host| self.is_host(&host)) {
            let why = "this name is not one of this server: see `husillo serve --host`\n";
            return Err((StatusCode::MISDIRECTED_REQUEST, why));
        }
        match headers.contains_key(header::ORIGIN) {
            false => Ok(()),
            true => match text(headers, header::ORIGIN)
                .and_then(|origin| Some(origin.strip_prefix("http://")?.to_owned()))
                .is_some_and(|host| self.is_host(&host))
            {
                true => Ok(()),
                false => Err((StatusCode::FORBIDDEN, "another site has no access\n")),
            },
        }
    }

    /// Permits a request with a token, from the header `Authorization` or from the address.
    ///
    /// # Errors
    ///
    /// The reason.
    pub fn of_machine(&self, headers: &HeaderMap, query: Option<&str>) -> Result<(), Refusal> {
        self.of_page(headers)?;
        let bearer = text(headers, header::AUTHORIZATION)
            .and_then(|value| Some(value.strip_prefix("bearer ")?.to_owned()));
        let given = bearer.or_else(|| query.map(str::to_owned));
        match given.is_some_and(|given| is_same(given.as_bytes(), self.token.as_bytes())) {
            true => Ok(()),
            false => Err((
                StatusCode::FORBIDDEN,
                "the token is not that of this run: open the address that `husillo serve` prints\n",
            )),
        }
    }

    fn is_host(&self, host: &str) -> bool {
        self.hosts.iter().any(|known| known == host)
    }
}

/// The value of a header that is there once, in small letters.
fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<String> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?.to_str().ok()?.to_ascii_lowercase();
    values.next().is_none().then_some(value)
}

/// Compares in a time that does not depend on the first difference.
fn is_same(given: &[u8], token: &[u8]) -> bool {
    let differences = given.iter().zip(token).fold(0, |all, (a, b)| all | (a ^ b));
    given.len() == token.len() && differences == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        let pairs = pairs.iter();
        pairs
            .map(|(name, value)| (name.clone(), value.parse().unwrap()))
            .collect()
    }

    fn access() -> Access {
        Access::new("127.0.0.1:8017".parse().unwrap(), &["mill.lan".into()]).unwrap()
    }

    #[test]
    fn only_names_of_this_server_are_served() {
        let access = access();
        for host in ["127.0.0.1:8017", "LOCALHOST:8017", "[::1]:8017", "mill.lan"] {
            assert_eq!(access.of_page(&headers(&[(header::HOST, host)])), Ok(()));
        }
        for host in ["127.0.0.1:80", "evil.example:8017", "evil.example", ""] {
            let refused = access.of_page(&headers(&[(header::HOST, host)]));
            assert_eq!(refused.unwrap_err().0, StatusCode::MISDIRECTED_REQUEST);
        }
        assert!(access.of_page(&HeaderMap::new()).is_err());
    }

    #[test]
    fn other_sites_are_refused() {
        let host = (header::HOST, "127.0.0.1:8017");
        let with = |origin| headers(&[host.clone(), (header::ORIGIN, origin)]);
        assert_eq!(access().of_page(&with("http://localhost:8017")), Ok(()));
        for origin in ["http://evil.example", "null", "https://localhost:8017", ""] {
            let refused = access().of_page(&with(origin)).unwrap_err();
            assert_eq!(refused.0, StatusCode::FORBIDDEN, "{origin}");
        }
    }

    #[test]
    fn a_machine_needs_the_token() {
        let access = access();
        let link = access.link();
        let token = link.split_once('#').unwrap().1;
        assert_eq!(token.len(), 32);
        let host = (header::HOST, "127.0.0.1:8017");
        let bare = headers(std::slice::from_ref(&host));
        assert_eq!(access.of_machine(&bare, Some(token)), Ok(()));
        let bearer = format!("Bearer {token}");
        let with = headers(&[host, (header::AUTHORIZATION, &bearer)]);
        assert_eq!(access.of_machine(&with, None), Ok(()));
        for wrong in [None, Some(""), Some("0"), Some(&token[1..])] {
            assert!(access.of_machine(&bare, wrong).is_err(), "{wrong:?}");
        }
    }
}
