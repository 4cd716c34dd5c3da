//! `fishplate keygen` and `fishplate sign`.

use super::kit::*;
use crate::data::write::replace;
use crate::provenance::signature::{PASSWORD, beside, content, new_keys, secret_key, sign};

#[derive(Debug, Args)]
pub struct Keygen {
    /// Name of the keys: NAME.key is the secret key, NAME.pub the public key. Neither file may
    /// exist.
    name: PathBuf,
    /// Do not protect the secret key with a password.
    #[arg(long)]
    no_password: bool,
}

#[derive(Debug, Args)]
pub struct Sign {
    /// Files to sign; each signature is written next to its file, as FILE.minisig.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Secret key of `fishplate keygen` or minisign. The password is requested, or read from
    /// FISHPLATE_KEY_PASSWORD.
    #[arg(long, value_name = "FILE")]
    key: PathBuf,
}

/// The password from the environment, if set.
pub fn password() -> Option<String> {
    std::env::var(PASSWORD).ok()
}

impl Keygen {
    pub fn run(self, console: &Console) -> Done {
        let with = |extension: &str| {
            let mut name = self.name.clone().into_os_string();
            name.push(extension);
            PathBuf::from(name)
        };
        let (secret, public) = (with(".key"), with(".pub"));
        if let Some(there) = [&secret, &public].into_iter().find(|path| disk::may_exist(path)) {
            let problem = Problem::error(
                "key-exists",
                format!("`{}` is there already; a key is never overwritten", there.display()),
            );
            return Err(problem.help("choose another name, or move the old key away").into());
        }
        let keys = new_keys(password(), !self.no_password).map_err(Ended::unfinished)?;
        let written = create(&secret, keys.0.as_bytes(), true).and_then(|()| {
            create(&public, keys.1.as_bytes(), false).inspect_err(|_| {
                // A secret key without its public key is not usable.
                let _ = disk::remove(&secret);
            })
        });
        written.map_err(Ended::unfinished)?;
        console.say(&format!(
            "written: {} (keep it secret), {} (publish it for verification)",
            secret.display(),
            public.display()
        ));
        Ok(Exit::Done)
    }
}

/// Creates a new file; only the owner can read a secret one.
fn create(path: &Path, bytes: &[u8], secret: bool) -> Result<(), Problem> {
    disk::create_new(path, bytes, secret).map_err(|error| {
        Problem::error("write-failed", format!("`{}` cannot be written: {error}", path.display()))
    })
}

impl Sign {
    pub fn run(self, console: &Console) -> Done {
        let key = secret_key(&self.key, password())?;
        // All files are read and signed before any signature is written.
        let mut signed = Vec::new();
        for path in &self.files {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let text = content(path).and_then(|bytes| sign(&key, &name, &bytes))?;
            signed.push((beside(path), text));
        }
        for (path, text) in signed {
            replace(&path, text.as_bytes()).map_err(Ended::unfinished)?;
            console.say(&format!("written: {}", path.display()));
        }
        Ok(Exit::Done)
    }
}
