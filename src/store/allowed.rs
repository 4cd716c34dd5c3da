//! Which URLs are opened: those that the environment of the program names.

use super::{Refused, is_url};

/// Environment variable with the beginnings of the URLs that may be read, separated by spaces.
pub const ALLOWED: &str = "FISHPLATE_STORES";

/// Schemes of stores.
const SCHEMES: [&str; 9] = ["s3", "s3a", "az", "azure", "abfs", "abfss", "gs", "http", "file"];

/// Checks that a URL may be opened.
///
/// # Errors
/// `url-invalid`, `store-not-allowed`.
pub fn check(url: &str, allowed: &str) -> Result<(), Refused> {
    let refused = |code, says: String, help: String| Err(Refused { code, says, help: Some(help) });
    let (scheme, path) = url.split_once("://").unwrap_or_default();
    if !SCHEMES.contains(&scheme) && scheme != "https" {
        let says = format!("`{url}` begins with `{scheme}://`, which is no store");
        return refused(
            "url-invalid",
            says,
            "stores are `s3://`, `az://`, `abfss://`, `gs://`, `https://`, `http://` and `file:///`".into(),
        );
    }
    // What is compared with the allowed beginnings must be what is asked for: nothing that is
    // resolved later.
    let strange =
        |c: char| c.is_whitespace() || c.is_control() || matches!(c, '\\' | '%' | '?' | '#');
    if path.contains(strange) || path.split('/').any(|part| matches!(part, "." | "..")) {
        let says = format!("`{url}` has a space, `%`, `?`, `#`, `\\`, or a part `.` or `..`");
        return refused(
            "url-invalid",
            says,
            "give the object another name, or copy it to the campaign's folder".into(),
        );
    }
    let begins = |with: &str| {
        url.strip_prefix(with)
            .is_some_and(|rest| with.ends_with('/') || rest.is_empty() || rest.starts_with('/'))
    };
    if scheme == "file" && !path.starts_with('/') {
        let says = format!("`{url}` names a host; a path of this machine begins with `file:///`");
        return refused(
            "url-invalid",
            says,
            "write the whole path, or mount the folder of the other machine".into(),
        );
    }
    if allowed.split_whitespace().filter(|with| is_url(with)).any(begins) {
        return Ok(());
    }
    let says = format!(
        "`{url}` may not be read: a campaign must not open a network connection, or a file outside its folder, unasked"
    );
    let whole = match scheme {
        "file" => url.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/")),
        _ => format!("{scheme}://{}/", path.split('/').next().unwrap_or_default()),
    };
    refused(
        "store-not-allowed",
        says,
        format!(
            "if you trust it, set the environment variable {ALLOWED} to `{whole}` or a longer beginning"
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_the_user_names_is_opened() {
        let code = |url: &str, allowed: &str| check(url, allowed).err().map(|refused| refused.code);
        for allowed in ["s3://runs", "s3://runs/", "s3://runs/2026", "https://x s3://runs"] {
            assert_eq!(code("s3://runs/2026/a.parquet", allowed), None, "{allowed}");
        }
        for allowed in [
            "",
            "s3",
            "s3:",
            "s3://run",
            "s3://runs/2",
            "s3://runs/2026/a.parquet/",
            "S3://runs",
            "https://runs",
        ] {
            assert_eq!(
                code("s3://runs/2026/a.parquet", allowed),
                Some("store-not-allowed"),
                "{allowed}"
            );
        }
        // The host is compared as a whole.
        assert_eq!(
            code("https://good.org.evil.org/a", "https://good.org"),
            Some("store-not-allowed")
        );
        assert_eq!(
            code("https://good.org@evil.org/a", "https://good.org"),
            Some("store-not-allowed")
        );
        for url in [
            "s3://runs/../keys",
            "s3://runs/%2e%2e/keys",
            "s3://runs/a?b",
            "s3://runs/a\\b",
            "ftp://runs/a",
            "file://host/a",
            "file:///etc/../a",
        ] {
            assert_eq!(
                code(url, "s3://runs ftp://runs file:///etc file://host"),
                Some("url-invalid"),
                "{url}"
            );
        }
        assert_eq!(
            code("file:///etc/passwd", "s3://runs file:///etc/pass"),
            Some("store-not-allowed")
        );
        assert_eq!(code("file:///archive/a.parquet", "file:///archive/"), None);
    }
}
