//! The error codes of NI-DAQmx that the simulation uses, and their messages.

pub const NOT_PRESENT: i32 = -88705;
pub const RESERVED: i32 = -50103;
pub const INVALID_VALUE: i32 = -200077;
pub const INVALID_TASK: i32 = -200088;
pub const NO_SUCH_CHANNEL: i32 = -200170;
pub const NO_SUCH_DEVICE: i32 = -200220;
pub const SMALL_BUFFER: i32 = -200229;
pub const STRING_TOO_LONG: i32 = -200228;
pub const OVERWRITTEN: i32 = -200279;
pub const NOT_THERE_YET: i32 = -200284;
pub const RAN_DRY: i32 = -200290;
pub const NOT_YET: i32 = -200292;
pub const NO_MORE_SPACE: i32 = -200293;
pub const NOT_STARTED: i32 = -200473;
pub const INVALID_SAMPLE: i32 = -200561;

pub fn words(code: i32) -> &'static str {
    match code {
        NOT_PRESENT => "the device is not present or not active in the system",
        RESERVED => "the resource is reserved by another task",
        INVALID_VALUE => "the requested value is not supported for this property",
        INVALID_TASK => "the task is not valid",
        NO_SUCH_CHANNEL => "the physical channel does not exist",
        NO_SUCH_DEVICE => "the device identifier is not valid",
        STRING_TOO_LONG => "the buffer is too small for the string",
        SMALL_BUFFER => "the buffer is too small to hold the samples read",
        OVERWRITTEN => {
            "the application is not able to keep up with the hardware acquisition: samples that were not read are overwritten"
        }
        NOT_THERE_YET => "some or all of the samples requested have not yet been acquired",
        NOT_STARTED => "the task is not started",
        RAN_DRY => "the generation has stopped to prevent the regeneration of old samples",
        NOT_YET => "some samples could not yet be written: the buffer is full",
        NO_MORE_SPACE => "there is no more space in the buffer, and the task is not started",
        INVALID_SAMPLE => "an analog sample is too large or too small",
        _ => "an error that this simulation does not know",
    }
}
