"""Copies a JPEG with an XMP packet as a DJI drone writes it, its properties given as NAME=VALUE.
Usage: with_xmp.py JPEG COPY RelativeAltitude=+60 GimbalYawDegree=0 ..."""

import sys

source, copy, *properties = sys.argv[1:]
attributes = " ".join('drone-dji:{}="{}"'.format(*text.split("=", 1)) for text in properties)
packet = (
    '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
    f'<rdf:Description rdf:about="" xmlns:drone-dji="http://www.dji.com/drone-dji/1.0/" {attributes}/>'
    "</rdf:RDF></x:xmpmeta>"
)
content = b"http://ns.adobe.com/xap/1.0/\0" + packet.encode()
with open(source, "rb") as stream:
    jpeg = stream.read()
assert jpeg[:2] == b"\xff\xd8", "not a JPEG"
with open(copy, "wb") as stream:
    stream.write(jpeg[:2] + b"\xff\xe1" + (len(content) + 2).to_bytes(2, "big") + content + jpeg[2:])
