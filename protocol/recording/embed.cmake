# cmake -D FROM=file -D TO=file.cc -P embed.cmake: writes the bytes of a file as C++, for recording::schema().
file(READ ${FROM} hex HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${TO} "#include \"protocol/recording/records.h\"
namespace visum::recording {
namespace {
constexpr unsigned char kSchema[] = {${bytes}};
}
Bytes schema() {
  return std::as_bytes(std::span(kSchema));
}
}  // namespace visum::recording
")
