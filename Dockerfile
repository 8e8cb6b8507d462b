# presswork in an image: docker build -t presswork . && docker run --rm -v "$PWD:/work" presswork run case.toml
FROM python:3.12-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends g++ && rm -rf /var/lib/apt/lists/*
COPY . /source
RUN pip wheel --no-cache-dir --no-deps /source -Ccmake.define.PRESSWORK_ARCH=portable -w /wheels

FROM python:3.12-slim
RUN apt-get update && apt-get install -y --no-install-recommends libgomp1 && rm -rf /var/lib/apt/lists/*
COPY --from=build /wheels /wheels
RUN pip install --no-cache-dir "$(ls /wheels/*.whl)[plot]" && rm -r /wheels
WORKDIR /work
ENTRYPOINT ["presswork"]
CMD ["--help"]
