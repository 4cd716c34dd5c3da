"""Records in S3, Azure and Google stores, as emulators of them answer: the same quantities and verdicts as from files.

    emulators.py PROGRAM [--only s3,azure,google]

PROGRAM was built with the feature `store`. Needs moto[server], boto3, azure-storage-blob, gcp-storage-emulator and google-cloud-storage
from pip, and azurite from npm; a store whose emulator is not on the PATH is skipped with a word. `tests/program/store/mod.rs` has the tests that
need nothing installed: a web server and `file://`.
"""

import argparse
import contextlib
import io
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / "examples" / "run"
#: Published with Azurite: the account that it always has.
ACCOUNT = "devstoreaccount1"
KEY = "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw=="
#: What each program is told of its store, and nothing of the machine's own credentials.
OURS = ("AWS_", "AZURE_", "AZURITE_", "GOOGLE_", "STORAGE_")


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@contextlib.contextmanager
def served(command, port, folder):
    with open(folder / "server.log", "wb") as log, subprocess.Popen(command, cwd=folder, stdout=log, stderr=log) as server:
        try:
            for _ in range(300):
                with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
                    break
                time.sleep(0.1)
            yield
        finally:
            server.terminate()


def s3(port, folder, files):
    """Uploads with the store's own client; gives the URL of the folder and the environment of the program."""
    import boto3

    client = boto3.client(
        "s3", endpoint_url=f"http://127.0.0.1:{port}", aws_access_key_id="test", aws_secret_access_key="test", region_name="us-east-1"
    )
    client.create_bucket(Bucket="archive")
    for file in files:
        client.upload_file(str(file), "archive", f"runs/{file.name}")
    environment = {"AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}", "AWS_ALLOW_HTTP": "true", "AWS_REGION": "us-east-1"}
    return "s3://archive/runs", environment | {"AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test"}


def azure(port, folder, files):
    from azure.storage.blob import BlobServiceClient

    client = BlobServiceClient(f"http://127.0.0.1:{port}/{ACCOUNT}", credential=KEY)
    container = client.create_container("archive")
    for file in files:
        container.upload_blob(f"runs/{file.name}", file.read_bytes())
    return "az://archive/runs", {"AZURE_STORAGE_USE_EMULATOR": "true", "AZURITE_BLOB_STORAGE_URL": f"http://127.0.0.1:{port}"}


def google(port, folder, files):
    from google.auth.credentials import AnonymousCredentials
    from google.cloud import storage

    client = storage.Client("test", AnonymousCredentials(), client_options={"api_endpoint": f"http://127.0.0.1:{port}"})
    bucket = client.create_bucket("archive")
    for file in files:
        bucket.blob(f"runs/{file.name}").upload_from_filename(str(file))
    account = folder / "account.json"
    told = {"gcs_base_url": f"http://127.0.0.1:{port}", "disable_oauth": True, "client_email": "", "private_key": "", "private_key_id": ""}
    account.write_text(json.dumps(told))
    return "gs://archive/runs", {"GOOGLE_SERVICE_ACCOUNT": str(account)}


def google_server(port):
    """The emulator of pip answers no HEAD and gives no tag and no time of change, as Google's XML interface does: they are added."""
    import gcp_storage_emulator.server as emulator

    class Handler(emulator.RequestHandler):
        head = False

        def do_HEAD(self):
            self.head = True
            emulator.Router(self).handle(emulator.GET)

        def end_headers(self):
            self.send_header("ETag", '"one"')
            self.send_header("Last-Modified", "Thu, 26 Nov 2026 10:00:00 GMT")
            super().end_headers()
            if self.head:
                self.wfile = io.BytesIO()

    emulator.RequestHandler = Handler
    emulator.create_server("127.0.0.1", port, True).run()


STORES = {
    "s3": (s3, lambda port: ["moto_server", "-p", str(port)]),
    "azure": (azure, lambda port: ["azurite-blob", "--blobPort", str(port), "--silent", "--skipApiVersionCheck", "--disableTelemetry"]),
    "google": (google, lambda port: [sys.executable, __file__, "--google-server", str(port)]),
}
NEEDED = {"s3": "moto_server", "azure": "azurite-blob", "google": "gcp-storage-emulator"}


def run(program, words, environment):
    clean = {name: value for name, value in os.environ.items() if not name.startswith(OURS)}
    done = subprocess.run([program, *map(str, words)], env=clean | environment, capture_output=True, text=True, cwd=EXAMPLE.parents[1])
    return done.returncode, done.stdout + done.stderr


def judged(program, campaign, environment):
    """What a campaign with a table of sections comes to, through `reduce` and `judge`."""
    values, out = campaign / "values.parquet", campaign / "judged"
    code, says = run(program, ["reduce", campaign, "--no-plots", "--out", values], environment)
    assert code == 0, says
    code, says = run(program, ["judge", values, "--only", "results", "--out", out], environment)
    assert code < 2, says
    found = json.loads((out / "results.json").read_text())
    assert len(found["quantities"]) > 10
    return [found[key] for key in ("verdict", "reasons", "quantities", "zones")], json.dumps(found)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", nargs="?")
    parser.add_argument("--google-server", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--only", default=",".join(STORES))
    given = parser.parse_args()
    if given.google_server:
        return google_server(given.google_server)
    if not given.program:
        parser.error("which program?")
    files = sorted((EXAMPLE / "records").iterdir())
    bad = []
    with tempfile.TemporaryDirectory() as top:
        near = pathlib.Path(top) / "near"
        shutil.copytree(EXAMPLE, near)
        table = near / "sections.csv"
        code, says = run(given.program, ["sections", near, "--out", table], {})
        assert code == 0, says
        campaign = near / "campaign.yaml"
        campaign.write_text("sections: sections.csv\n" + campaign.read_text())
        expected, _ = judged(given.program, near, {})
        for name in given.only.split(","):
            upload, command = STORES[name]
            port, folder = free_port(), pathlib.Path(top) / name
            if shutil.which(NEEDED[name]) is None:
                print(f"{name}: skipped, there is no {NEEDED[name]}")
                continue
            shutil.copytree(near, folder, ignore=shutil.ignore_patterns("records", "judged", "values.parquet"))
            with served(command(port), port, folder):
                url, environment = upload(port, folder, files)
                far = folder / "campaign.yaml"
                far.write_text(campaign.read_text().replace(": records/", f": {url}/"))
                try:
                    found, text = judged(given.program, folder, environment | {"FISHPLATE_STORES": f"{url}/"})
                    assert found == expected, "other quantities or verdicts than from files"
                    assert f"{url}/north-measured.parquet" in text, "the results do not name the object"
                    code, says = run(given.program, ["reduce", folder, "--out", folder / "v.parquet"], environment)
                    assert "may not be read" in says, f"a store that is not allowed was not refused: {code}, {says}"
                    print(f"{name}: the same quantities and verdicts from {url} as from files")
                except AssertionError as wrong:
                    bad.append(name)
                    print(f"{name}: {wrong}")
    sys.exit(bool(bad))


if __name__ == "__main__":
    main()
