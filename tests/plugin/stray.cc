// A shared library that is no plug-in.
extern "C" int visum_stray() {
  return 1;
}
