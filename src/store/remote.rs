//! Objects, read through the crate `object_store`.

use std::{
    error::Error,
    fmt, io,
    ops::Range,
    sync::{Arc, OnceLock},
    time::Duration,
};

use bytes::Bytes;
use object_store::{
    BackoffConfig, ClientOptions, GetOptions, ObjectStore, ObjectStoreExt, ObjectStoreScheme,
    RetryConfig, aws::AmazonS3Builder, azure::MicrosoftAzureBuilder, coalesce_ranges,
    gcp::GoogleCloudStorageBuilder, http::HttpBuilder, local::LocalFileSystem, path::Path,
};
use tokio::runtime::{Builder, Runtime};
use url::Url;

use super::{
    Refused,
    allowed::{ALLOWED, check},
};

/// Parts that lie closer together than this are read by one request. A request takes as long as
/// some 100 kB do.
const GAP: u64 = 128 << 10;
/// How often a request is made again after a fault of the connection or the server, and for how
/// long in all.
const RETRIES: (usize, Duration) = (3, Duration::from_secs(60));
/// How long a request may take.
const REQUEST: Duration = Duration::from_secs(60);

/// An object of which parts can be read.
#[derive(Clone, Debug)]
pub struct Object(Arc<Remote>);

#[derive(Debug)]
struct Remote {
    url: String,
    store: Box<dyn ObjectStore>,
    path: Path,
    size: u64,
    tag: Option<String>,
    version: String,
}

impl Object {
    /// Looks for an object whose URL the environment of the program allows.
    ///
    /// # Errors
    /// `url-invalid`, `store-not-allowed`, `file-missing`, `file-unreadable`.
    pub fn find(url: &str) -> Result<Self, Refused> {
        check(url, &std::env::var(ALLOWED).unwrap_or_default())?;
        let refused = |code, why: String| Refused { code, says: why, help: None };
        let unreadable = |why: &dyn fmt::Display| {
            refused("file-unreadable", format!("`{url}` cannot be read: {why}"))
        };
        let (store, path) = opened(url).map_err(|error| unreadable(&reason(&error)))?;
        let meta = runtime()
            .map_err(|error| unreadable(&error))?
            .block_on(store.head(&path))
            .map_err(|error| match error {
                object_store::Error::NotFound { .. } => {
                    refused("file-missing", format!("there is no object `{url}`"))
                }
                other => unreadable(&reason(&other)),
            })?;
        let version = meta.e_tag.clone().unwrap_or_else(|| meta.last_modified.to_rfc3339());
        Ok(Self(Arc::new(Remote {
            url: url.to_string(),
            store,
            path,
            size: meta.size,
            tag: meta.e_tag,
            version,
        })))
    }

    pub fn url(&self) -> &str {
        &self.0.url
    }

    pub fn size(&self) -> u64 {
        self.0.size
    }

    /// What differs when the object is written again: its tag, or without one the time of its last
    /// change.
    pub fn version(&self) -> &str {
        &self.0.version
    }

    /// Reads parts of the object.
    ///
    /// # Errors
    /// Why they cannot be read.
    pub fn read(&self, ranges: &[Range<u64>]) -> Result<Vec<Bytes>, String> {
        let found = &self.0;
        let one = |range: Range<u64>| async move {
            let count = range.end - range.start;
            // An object that was replaced in between is refused by the store.
            let options = GetOptions {
                if_match: found.tag.clone(),
                range: Some(range.into()),
                ..GetOptions::default()
            };
            let got =
                found.store.get_opts(&found.path, options).await.map_err(|error| reason(&error))?;
            let bytes = got.bytes().await.map_err(|error| reason(&error))?;
            match bytes.len() as u64 {
                read if read == count => Ok(bytes),
                read => Err(format!("the store gave {read} bytes where {count} were asked for")),
            }
        };
        let whole: Vec<Range<u64>> =
            ranges.iter().filter(|range| !range.is_empty()).cloned().collect();
        let mut read = runtime()
            .map_err(|error| error.to_string())?
            .block_on(coalesce_ranges(&whole, one, GAP))?
            .into_iter();
        Ok(ranges
            .iter()
            .map(
                |range| {
                    if range.is_empty() { Bytes::new() } else { read.next().unwrap_or_default() }
                },
            )
            .collect())
    }
}

/// The store of a URL, with credentials from the environment, and the path in it.
fn opened(url: &str) -> Result<(Box<dyn ObjectStore>, Path), object_store::Error> {
    let generic = |source: Box<dyn Error + Send + Sync>| object_store::Error::Generic {
        store: "URL",
        source,
    };
    let parsed = Url::parse(url).map_err(|error| generic(Box::new(error)))?;
    let (scheme, path) = ObjectStoreScheme::parse(&parsed)?;
    let options =
        ClientOptions::new().with_timeout(REQUEST).with_allow_http(parsed.scheme() == "http");
    let backoff = BackoffConfig { max_backoff: Duration::from_secs(5), ..BackoffConfig::default() };
    let retry = RetryConfig { backoff, max_retries: RETRIES.0, retry_timeout: RETRIES.1 };
    let store: Box<dyn ObjectStore> = match scheme {
        ObjectStoreScheme::AmazonS3 => {
            Box::new(AmazonS3Builder::from_env().with_url(url).with_retry(retry).build()?)
        }
        ObjectStoreScheme::MicrosoftAzure => {
            Box::new(MicrosoftAzureBuilder::from_env().with_url(url).with_retry(retry).build()?)
        }
        ObjectStoreScheme::GoogleCloudStorage => {
            Box::new(GoogleCloudStorageBuilder::from_env().with_url(url).with_retry(retry).build()?)
        }
        ObjectStoreScheme::Http => {
            let host = &parsed[..url::Position::BeforePath];
            Box::new(
                HttpBuilder::new()
                    .with_url(host)
                    .with_client_options(options)
                    .with_retry(retry)
                    .build()?,
            )
        }
        // A path may lead through symbolic links: the user allowed what it begins with.
        ObjectStoreScheme::Local => Box::new(LocalFileSystem::new()),
        _ => return Err(generic("it is no store that is read".into())),
    };
    Ok((store, path))
}

/// One runtime for all stores; its thread drives the connections of all threads that read.
fn runtime() -> Result<&'static Runtime, io::Error> {
    static RUNTIME: OnceLock<Runtime> = OnceLock::new();
    if let Some(runtime) = RUNTIME.get() {
        return Ok(runtime);
    }
    let made =
        Builder::new_multi_thread().worker_threads(1).thread_name("store").enable_all().build()?;
    Ok(RUNTIME.get_or_init(|| made))
}

/// An error with its causes, in one line.
fn reason(error: &dyn Error) -> String {
    const MOST: usize = 300;
    let mut causes = vec![error.to_string()];
    let mut next = error.source();
    while let Some(cause) = next {
        let says = cause.to_string();
        if !causes.iter().any(|known| known.contains(&says)) {
            causes.push(says);
        }
        next = cause.source();
    }
    causes.join(": ").chars().map(|c| if c.is_control() { ' ' } else { c }).take(MOST).collect()
}
