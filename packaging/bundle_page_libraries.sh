#!/usr/bin/env bash
# Bundles three.js and uPlot for the page of `presswork report` into src/presswork/report/page/libraries/, each with its
# licence on top, from the npm registry. Needs Node.js 18 or newer. Run it to take newer versions.
set -euo pipefail
three=0.187.0 uplot=1.6.32 esbuild=0.28.2
target=$(cd "$(dirname "$0")/.." && pwd)/src/presswork/report/page/libraries
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-fund --no-audit "three@$three" "uplot@$uplot" "esbuild@$esbuild"
cat > three.js <<'END'
export {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, EdgesGeometry, GLSL3, Group, LinearFilter, LineSegments,
  Mesh, NearestFilter, OrthographicCamera, RawShaderMaterial, RGBAFormat, Scene, Vector3, Vector4, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
END
echo 'export { default } from "uplot";' > uplot.js
bundle() {  # name, version
  npx esbuild "$1.js" --bundle --format=esm --minify --legal-comments=none --outfile="bundled/$1.js" --log-level=error
  { echo "/* $1 $2"; echo; cat "node_modules/$1/LICENSE"; echo "*/"; cat "bundled/$1.js"; } > "$target/$1.js"
}
bundle three "$three"
bundle uplot "$uplot"
