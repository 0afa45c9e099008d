"""Serves a folder on this machine as catalogues are served: parts of files by HTTP's Range, JSON without a size.

serve.py FOLDER PORT_FILE: the port is written to PORT_FILE when it listens."""

import http.server
import pathlib
import re
import sys


class Handler(http.server.BaseHTTPRequestHandler):
    def answer(self, with_body):
        path = pathlib.Path(sys.argv[1]) / pathlib.PurePosixPath(self.path.partition("?")[0]).name
        if not path.is_file():
            self.send_error(404)
            return
        content = path.read_bytes()
        asked = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        if path.suffix == ".json":  # as an answer that is made while it is sent
            self.send_response(200)
        elif asked:
            first, last = int(asked[1]), min(int(asked[2] or len(content) - 1), len(content) - 1)
            self.send_response(206)
            self.send_header("Content-Range", f"bytes {first}-{last}/{len(content)}")
            content = content[first:last + 1]
            self.send_header("Content-Length", str(len(content)))
        else:
            self.send_response(200)
            self.send_header("Content-Length", str(len(content)))
        self.send_header("Accept-Ranges", "bytes")
        self.end_headers()
        if with_body:
            self.wfile.write(content)

    def do_GET(self):
        self.answer(True)

    def do_HEAD(self):
        self.answer(False)

    def log_message(self, *_):
        pass


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
pathlib.Path(sys.argv[2]).write_text(str(server.server_port))
server.serve_forever()
