# Tinsmith in a container: terrains are kept in /data, the server listens on port 8080.
#
#   docker build -t tinsmith .
#   docker run -p 8080:8080 -v terrains:/data tinsmith

FROM debian:bookworm-slim AS build
ENV DEBIAN_FRONTEND=noninteractive
COPY deploy/packages.txt /packages.txt
RUN apt-get update -qq \
 && apt-get install -y -qq --no-install-recommends $(awk '$1 == "build" { print $2 }' /packages.txt) \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
RUN cmake --preset release -DTINSMITH_TESTS=OFF \
 && cmake --build --preset release \
 && strip --strip-debug -o /tinsmith build/release/tinsmith

FROM debian:bookworm-slim
COPY deploy/packages.txt /packages.txt
RUN apt-get update -qq \
 && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
      $(awk '$1 == "run" { print $2 }' /packages.txt) \
 && rm -rf /var/lib/apt/lists/* /packages.txt \
 && useradd --uid 10001 --user-group --no-create-home --home-dir /data --shell /usr/sbin/nologin tinsmith \
 && install -d -o tinsmith -g tinsmith /data
COPY --from=build /tinsmith /usr/local/bin/tinsmith
USER 10001:10001
VOLUME /data
EXPOSE 8080
HEALTHCHECK --interval=30s --timeout=5s --start-period=30s \
  CMD ["curl", "-fsS", "-o", "/dev/null", "http://127.0.0.1:8080/healthz"]
ENTRYPOINT ["tinsmith"]
# Whoever reaches the published port may do anything; with tokens in a configuration leave --insecure away.
CMD ["serve", "--listen", "0.0.0.0:8080", "--data", "/data", "--insecure"]
