# docker build -t fem-seal .
# docker run --rm -v "$PWD:/work" fem-seal run case.toml
FROM python:3.12-slim

WORKDIR /opt/fem-seal
# the libraries of gmsh, and those that draw pictures in space without a display
COPY .ci/system .ci/system
RUN .ci/system program pictures && rm -rf /var/lib/apt/lists/*

COPY pyproject.toml README.md LICENSE ./
COPY fem_seal fem_seal
COPY leak leak
COPY meshes meshes
RUN pip install --no-cache-dir ".[coolprop,drawings,studies,surfaces]" && fem-seal --version

# results belong to whoever calls it: docker run --user "$(id -u):$(id -g)" ...
ENV MPLCONFIGDIR=/tmp/matplotlib
WORKDIR /work
ENTRYPOINT ["fem-seal"]
CMD ["--help"]
