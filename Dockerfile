# Build the wheel and install it with its locked dependencies into one virtual environment.
# DIGEST fixes the content of the base, as @sha256:...; without one the tag does not.
ARG DIGEST=
FROM python:3.13-slim${DIGEST} AS build
WORKDIR /source
RUN python -m venv /opt/shapersmith \
    && python -m venv /opt/build \
    && /opt/build/bin/pip install --no-cache-dir hatchling
COPY requirements-extras.lock ./
RUN /opt/shapersmith/bin/pip install --no-cache-dir --require-hashes -r requirements-extras.lock
COPY pyproject.toml README.md LICENSE ./
COPY shapersmith shapersmith
COPY design design
COPY schemas schemas
COPY service service
RUN /opt/build/bin/pip wheel --no-deps --no-build-isolation --wheel-dir /wheels . \
    && /opt/shapersmith/bin/pip install --no-cache-dir --no-deps /wheels/*.whl \
    && /opt/shapersmith/bin/pip uninstall --yes pip

FROM python:3.13-slim${DIGEST}
RUN useradd --system --no-create-home shapersmith \
    && mkdir /var/lib/shapersmith \
    && chown shapersmith /var/lib/shapersmith
COPY --from=build /opt/shapersmith /opt/shapersmith
ENV PATH=/opt/shapersmith/bin:$PATH PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR=/tmp/matplotlib \
    SHAPERSMITH_DATA_DIR=/var/lib/shapersmith NUMBA_CACHE_DIR=/var/lib/shapersmith/compiled
VOLUME /var/lib/shapersmith
USER shapersmith
EXPOSE 8000
# The first start on a new volume compiles what tables need.
HEALTHCHECK --interval=10s --timeout=5s --start-period=180s \
    CMD ["python", "-c", "import urllib.request as u; u.urlopen('http://127.0.0.1:8000/health/ready')"]
CMD ["python", "-m", "service.jobs.warming", "shapersmith", "serve", "--host", "0.0.0.0", "--port", "8000"]
