# Build the wheel and install it with its locked dependencies into one virtual environment.
FROM python:3.11-slim AS build
WORKDIR /source
RUN python -m venv /opt/shapersmith
COPY requirements.lock requirements-dev.lock ./
RUN /opt/shapersmith/bin/pip install --no-cache-dir --require-hashes -r requirements.lock
COPY pyproject.toml README.md LICENSE ./
COPY shapersmith shapersmith
COPY design design
COPY schemas schemas
COPY service service
# The build backend comes from the lock too, into an environment of its own.
RUN python -m venv /opt/build \
    && /opt/build/bin/pip install --no-cache-dir --require-hashes -r requirements-dev.lock \
    && /opt/build/bin/pip wheel --no-deps --no-build-isolation --wheel-dir /wheels . \
    && /opt/shapersmith/bin/pip install --no-cache-dir --no-deps /wheels/*.whl \
    && /opt/shapersmith/bin/pip uninstall --yes pip setuptools

FROM python:3.11-slim
RUN useradd --system --no-create-home shapersmith \
    && install -d -o shapersmith /var/lib/shapersmith
COPY --from=build /opt/shapersmith /opt/shapersmith
ENV PATH=/opt/shapersmith/bin:$PATH PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR=/tmp/matplotlib \
    SHAPERSMITH_DATA_DIR=/var/lib/shapersmith
VOLUME /var/lib/shapersmith
USER shapersmith
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=5s --start-period=30s \
    CMD ["python", "-c", "import urllib.request as u; u.urlopen('http://127.0.0.1:8000/health/ready')"]
CMD ["shapersmith", "serve", "--host", "0.0.0.0", "--port", "8000"]
